// What children write is read, or refused with a sentence; the daemon goes on whatever it is.
#include "delivery/child_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "delivery/job_folder.h"
#include "fixtures/fault_of.h"
#include "unit/daemon/workshop.h"

namespace packmerger {
namespace {

using fixtures::fault_of;

const char* const kGood = R"({"version": 1, "variant": "packed", "seed": 1, "profile": {"id": "x"},
  "inputs": [{"file": "bunny.stl", "sha256": "ab"}], "parts": [{"tray": 1}],
  "warnings": [{"code": "suspicious_size", "text": "small"}],
  "estimates": {"packed": {"fits": true, "cost": 1, "time_s": 2, "parts": 2, "trays": 1,
                           "currency": "EUR", "source": "slicer"},
                "hollow": {"fits": false, "reason": "No wall is kept", "hint": "Raise wall_mm."}}})";

std::string nested(int levels) {
  const auto count = static_cast<std::size_t>(levels);
  return std::string(count, '[') + std::string(count, ']');
}

TEST(ChildJson, AReportWithAnyOneValueReplacedIsReadOrRefused) {
  const TemporaryFolder folder;
  const json good = json::parse(kGood);
  const auto read = [&](const json& report) {
    std::ofstream(folder.path() / "job.json") << report.dump();
    const PreparedJob job = read_prepared(folder.path());
    doubt_about(job);
  };
  EXPECT_NO_THROW(read(good));
  int refused = 0;
  const json places = good.flatten();
  for (const auto& item : places.items())
    for (const json& value :
         {json(nullptr), json("x"), json(-1), json(1e300), json(1.5), json(true), json(UINT64_MAX),
          json::array({1}), json::object({{"a", 1}})}) {
      json changed = good;
      changed[json::json_pointer(item.key())] = value;
      try {
        read(changed);
      } catch (const Error& error) {
        ++refused;
        EXPECT_EQ(error.fault(), Fault::kBadInput) << item.key() << value;
        EXPECT_FALSE(error.hint().empty());
      }
    }
  EXPECT_GT(refused, 80);
}

TEST(ChildJson, WhatIsNestedTooDeeplyIsRefused) {
  EXPECT_TRUE(parse_child_json(nested(20)).is_array());
  EXPECT_TRUE(parse_child_json(nested(2000000)).is_discarded());
  EXPECT_EQ(fault_of([] { compared_estimates("{\"x\":{\"packed\":" + nested(500000) + "}}"); }),
            Fault::kBadInput);
  EXPECT_EQ(fault_of([] { compared_estimates(R"({"x":{"packed":{"parts":"two"}}})"); }),
            Fault::kBadInput);
}

// As if the check had overlooked something.
TEST(ChildJson, WhateverIsThrownFailsTheJobAndNotTheDaemon) {
  Workshop shop;
  shop.queues_->senders.erase("sim");  // whoever asks for it is thrown std::out_of_range
  shop.drop("sim", "a.stl");
  shop.prepare(*shop.prepare_order());
  EXPECT_EQ(shop.job(1).state, JobState::kFailed);
  EXPECT_THAT(shop.job(1).reason, testing::StartsWith("It could not be gone on with"));
  EXPECT_FALSE(shop.job(1).hint.empty());
  shop.drop("real", "b.stl");
  EXPECT_TRUE(shop.prepare_order()) << "the worker is free again";
}

TEST(ChildJson, AToldFileOfAnyKindKeepsNoDaemonFromStarting) {
  for (const std::string& text :
       {std::string(5000, 'x'), std::string("acknowledged 9 of 3\n"), std::string("\n")}) {
    Workshop shop;
    shop.drop("sim", "a.stl");
    shop.prepare(*shop.prepare_order());
    const SendOrder send = shop.send_order("sim").value();
    std::ofstream(send.told_file) << text;
    shop.start();
    EXPECT_EQ(shop.job(1).state, JobState::kFailed);
    EXPECT_EQ(shop.job(1).reason, "interrupted while printing");
  }
}

}  // namespace
}  // namespace packmerger
