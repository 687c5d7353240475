#include "daemon/workers/worker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "base/files.h"

namespace packmerger {
namespace {

using testing::HasSubstr;

TEST(ProgressLine, ReadsWhatPackmergerWrites) {
  EXPECT_EQ(progress_line("[ 42%] packing")->stage, "packing");
  EXPECT_EQ(progress_line("[ 42%] packing")->fraction, 0.42);
  EXPECT_EQ(progress_line("[100%] writing")->fraction, 1);
  for (const char* text : {"", "[", "[]", "[%] x", "[ 4x%] y", "[101%] z", "[-1%] z", "warning: x",
                           "[    %] x", "42%] packing"})
    EXPECT_FALSE(progress_line(text)) << text;
}

TEST(ChildFailure, TakesTheLastErrorAndHint) {
  const Failure failure =
      child_failure(65, 0, "[ 1%] x\nerror: one.\nerror: Not closed.\nhint: Repair it.\n");
  EXPECT_EQ(failure.fault, Fault::kBadInput);
  EXPECT_EQ(failure.what, "Not closed");
  EXPECT_EQ(failure.hint, "Repair it.");
  EXPECT_EQ(child_failure(99, 0, "").fault, Fault::kInternal);
  EXPECT_THAT(child_failure(99, 0, "").what, HasSubstr("99"));
  EXPECT_THAT(child_failure(0, SIGSEGV, "").what, HasSubstr("crash"));
  EXPECT_FALSE(child_failure(0, SIGSEGV, "").hint.empty());
}

// Runs the worker on a thread of its own, with a stand-in for packmerger.
class WorkerTest : public testing::Test {
 protected:
  void SetUp() override {
    const char* source = std::getenv("PACKMERGER_SOURCE");
    if (source == nullptr) GTEST_SKIP() << "PACKMERGER_SOURCE is not set; run it with ctest";
    program_ = fs::path(source) / "tests/unit/daemon/fake_prepare.py";
    thread_ = std::thread([this] { run_worker(orders_, events_); });
  }
  void TearDown() override {
    orders_.close();
    if (thread_.joinable()) thread_.join();
  }

  PrepareOrder order(const std::string& name) {
    std::ofstream(folder_.path() / name) << "model " << name;
    PrepareOrder order;
    order.job = 5;
    order.input = folder_.path() / name;
    order.out = folder_.path() / "job";
    order.argv = {program_.string(), "prepare", order.input.string(), "--profile",
                  "marlin",          "--out",   order.out.string()};
    order.limits.memory_bytes = std::uint64_t{1} << 30;
    order.cancel = std::make_shared<std::atomic<bool>>(false);
    return order;
  }

  // The event that ends the order; what came before is kept in before_.
  Event end_of(const PrepareOrder& order) {
    orders_.push(order);
    for (;;) {
      Event event = *events_.pop();
      if (std::holds_alternative<Prepared>(event) || std::holds_alternative<PrepareFailed>(event))
        return event;
      before_.push_back(std::move(event));
    }
  }

  TemporaryFolder folder_;
  fs::path program_;
  Queue<PrepareOrder> orders_;
  Queue<Event> events_;
  std::thread thread_;
  std::vector<Event> before_;
};

TEST_F(WorkerTest, PreparesAndTellsWhatIsThere) {
  const Prepared prepared = std::get<Prepared>(end_of(order("slow-two.stl")));
  EXPECT_EQ(prepared.job, 5);
  EXPECT_EQ(prepared.trays, 2);
  EXPECT_TRUE(prepared.doubt.empty());
  int progress = 0;
  bool hashed = false;
  for (const Event& event : before_) {
    if (std::holds_alternative<PrepareProgress>(event)) ++progress;
    if (const auto* hash = std::get_if<Hashed>(&event))
      hashed = hash->sha256 == sha256_hex_of_file(folder_.path() / "slow-two.stl");
  }
  EXPECT_TRUE(hashed);
  EXPECT_GT(progress, 3);
  EXPECT_FALSE(fs::exists(folder_.path() / "tmp"));
}

TEST_F(WorkerTest, TellsWhyItFailed) {
  const PrepareFailed failed = std::get<PrepareFailed>(end_of(order("broken.stl")));
  EXPECT_EQ(failed.failure.fault, Fault::kBadInput);
  EXPECT_EQ(failed.failure.what, "The model has holes that cannot be closed");
  EXPECT_EQ(failed.failure.hint, "Repair it in another program.");
  EXPECT_THAT(std::get<PrepareFailed>(end_of(order("crash.stl"))).failure.what, HasSubstr("crash"));
  EXPECT_TRUE(std::holds_alternative<Prepared>(end_of(order("good.stl")))) << "and goes on";
}

TEST_F(WorkerTest, WhatNoChildMayLeaveFailsItsJob) {
  for (const char* name : {"types.stl", "pipe.stl", "link.stl"}) {
    PrepareOrder each = order(name);
    each.out = folder_.path() / name / "job";
    fs::remove(each.input);
    each.input = folder_.path() / (std::string("model-") + name);
    std::ofstream(each.input) << "model";
    each.argv[2] = each.input.string();
    each.argv.back() = each.out.string();
    fs::create_directories(each.out.parent_path());
    const Event end = end_of(each);
    ASSERT_TRUE(std::holds_alternative<PrepareFailed>(end)) << name;
    EXPECT_EQ(std::get<PrepareFailed>(end).failure.fault, Fault::kBadInput) << name;
    EXPECT_FALSE(std::get<PrepareFailed>(end).failure.hint.empty()) << name;
  }
}

TEST_F(WorkerTest, AHungryChildIsStopped) {
  EXPECT_THAT(std::get<PrepareFailed>(end_of(order("memory.stl"))).failure.what,
              HasSubstr("not enough memory"));
}

TEST_F(WorkerTest, CancellingEndsGrandchildrenToo) {
  const PrepareOrder hanging = order("hang.stl");
  std::thread canceller([&] {
    while (!fs::exists(folder_.path() / "grandchild.pid") ||
           fs::file_size(folder_.path() / "grandchild.pid") == 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    *hanging.cancel = true;
  });
  const PrepareFailed failed = std::get<PrepareFailed>(end_of(hanging));
  canceller.join();
  EXPECT_EQ(failed.failure.fault, Fault::kInterrupted);
  const pid_t grandchild = std::stoi(read_file(folder_.path() / "grandchild.pid", 100));
  bool gone = false;
  for (int i = 0; i < 100 && !gone; ++i) {
    std::ifstream status("/proc/" + std::to_string(grandchild) + "/stat");
    std::string number;
    std::string name;
    std::string state = "Z";  // no process at all, or one that only waits to be reaped
    status >> number >> name >> state;
    gone = state == "Z";
    if (!gone) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_TRUE(gone);
}

TEST_F(WorkerTest, AHangingChildIsEndedByItsLimit) {
  TearDown();
  Queue<PrepareOrder> orders;
  PrepareOrder hanging = order("hang.stl");
  hanging.limits.time_s = 1;
  orders.push(hanging);
  orders.close();
  run_worker(orders, events_);
  std::optional<Event> last;
  while (auto event = events_.try_pop()) last = std::move(event);
  EXPECT_THAT(std::get<PrepareFailed>(*last).failure.what, HasSubstr("longer than 1 s"));
}

TEST_F(WorkerTest, AMissingProgramIsTold) {
  PrepareOrder lost = order("good.stl");
  lost.argv[0] = "/nonexistent/packmerger";
  EXPECT_EQ(std::get<PrepareFailed>(end_of(lost)).failure.fault, Fault::kUnavailable);
}

}  // namespace
}  // namespace packmerger
