// That what is printed is proved, and what follows where a proof fails. This program has a proof of
// its own in place of the real one, which answers as a test tells it: it is linked before the
// library.
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/files.h"
#include "fixtures/models.h"
#include "job/pack_models.h"
#include "job/prepare.h"
#include "job/promises.h"
#include "model/stl.h"
#include "pack/exact/exact_gap.h"

namespace packmerger {
namespace {

using testing::HasSubstr;

struct Asked {
  double gap_mm;
  Vec3 room_mm;
  double least_mm;  // between the parts that were to be proved
};

std::vector<Asked> asked;
std::deque<std::optional<BrokenPromise>> answers;  // once these are used up, all promises are kept

const BrokenPromise kBroken{"Two parts quarrel", 0.5};

}  // namespace

std::optional<BrokenPromise> broken_promise(const Arrangement& arrangement, double gap_mm,
                                            const Room& room, const Progress&) {
  std::vector<Mesh> parts;
  for (const JobPart& part : arrangement.parts)
    parts.push_back(transformed(part.surface, part.pose));
  asked.push_back({gap_mm, room.size_mm, least_gap_mm(parts)});
  if (answers.empty()) return std::nullopt;
  const std::optional<BrokenPromise> answer = answers.front();
  answers.pop_front();
  return answer;
}

namespace {

class ProvedLayouts : public testing::Test {
 protected:
  ProvedLayouts() {
    asked.clear();
    answers.clear();
    const Mesh cube = closed_mesh(fixtures::cube(20));
    const fs::path path = folder_.path() / "cube.stl";
    write_file_whole(path, binary_stl({&cube}));
    options_.models = {path, path};
    options_.split = false;
    profile_.shape.wall_mm = 2;
    profile_.pack.gap_mm = 1;
    profile_.pack.rotation_step_deg = 90;
  }

  Job prepared(Variant variant) { return prepare(profile_, options_, variant, out_, Progress()); }

  // What preparing that way ends with.
  Error refusal(Variant variant) {
    try {
      prepared(variant);
    } catch (const Error& error) {
      return error;
    }
    ADD_FAILURE() << "it was prepared";
    return Error(Fault::kInternal, "", "");
  }

  TemporaryFolder folder_;
  fs::path out_ = folder_.path() / "out";
  Profile profile_ = read_profile("objet30");
  PlanOptions options_;
};

TEST_F(ProvedLayouts, ALayoutThatBreaksAPromiseIsPackedAgainWithMoreRoom) {
  answers = {kBroken};
  prepared(Variant::kPacked);
  ASSERT_EQ(asked.size(), 3u) << "both layouts, and what is written";
  EXPECT_GE(asked[0].least_mm, 1 - 1e-6);
  EXPECT_LT(asked[0].least_mm, 1.5);
  EXPECT_GE(asked[1].least_mm, 1 + kBroken.missing_mm);
  for (const Asked& each : asked) EXPECT_EQ(each.gap_mm, 1) << "what the profile promises";
  EXPECT_EQ(asked[2].least_mm, asked[1].least_mm);
  EXPECT_EQ(asked[2].room_mm, profile_.build());
  EXPECT_TRUE(fs::exists(out_ / "job.json"));
}

TEST_F(ProvedLayouts, AfterThreeLayoutsNothingIsWritten) {
  answers = {kBroken, kBroken, kBroken};
  const Error error = refusal(Variant::kPacked);
  EXPECT_EQ(error.fault(), Fault::kInternal);
  EXPECT_THAT(error.what(), HasSubstr("Two parts quarrel, and another layout did not help"));
  ASSERT_EQ(asked.size(), 3u);
  EXPECT_GE(asked[2].least_mm, 1 + 2 * kBroken.missing_mm);
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(ProvedLayouts, WhateverWayIsWrittenIsProvedOnceMore) {
  for (const Variant variant : {Variant::kPacked, Variant::kHollow, Variant::kSolid}) {
    asked.clear();
    answers = {std::nullopt, kBroken};  // the packed layout's, and that of what is to be written
    const Error error = refusal(variant);
    EXPECT_EQ(error.fault(), Fault::kInternal);
    EXPECT_THAT(error.what(), HasSubstr("Two parts quarrel")) << variant_name(variant);
    EXPECT_THAT(error.hint(), HasSubstr("Nothing was written")) << variant_name(variant);
    EXPECT_EQ(asked.size(), 2u) << variant_name(variant);
    EXPECT_FALSE(fs::exists(out_)) << variant_name(variant);
  }
}

}  // namespace
}  // namespace packmerger
