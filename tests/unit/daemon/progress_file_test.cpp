#include "delivery/progress_file.h"

#include <gtest/gtest.h>

#include <fstream>

#include "fixtures/fault_of.h"

namespace packmerger {
namespace {

TEST(ProgressFile, HoldsTheLastRecordAlone) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "sent-1.progress";
  EXPECT_FALSE(read_told(path));
  EXPECT_TRUE(has_sent_nothing(path));
  ProgressFile file(path);
  EXPECT_FALSE(read_told(path)) << "nothing was acknowledged";
  EXPECT_TRUE(has_sent_nothing(path));
  for (const std::size_t done : {0u, 7u, 123456u, 4u}) {
    file.acknowledged(done, 200000);
    const std::optional<Told> told = read_told(path);
    ASSERT_TRUE(told);
    EXPECT_EQ(told->done, done);
    EXPECT_EQ(told->total, 200000u);
    EXPECT_LT(fs::file_size(path), 64u);
    EXPECT_FALSE(has_sent_nothing(path));
  }
  // The next print covers it as soon as it begins, not before.
  ProgressFile next(path);
  EXPECT_EQ(read_told(path)->done, 4u);
  next.acknowledged(0, 30);
  EXPECT_EQ(read_told(path)->total, 30u);
}

TEST(ProgressFile, WhatIsNoRecordTellsNothing) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "sent-1.progress";
  std::ofstream(path) << "acknowledged twelve";
  EXPECT_FALSE(read_told(path));
  EXPECT_FALSE(has_sent_nothing(path)) << "nobody knows";
}

TEST(ProgressFile, AFolderThatIsNotThereIsTold) {
  EXPECT_EQ(fixtures::fault_of([] { ProgressFile("/nonexistent/sent-1.progress"); }),
            Fault::kCannotWrite);
}

TEST(ProgressFile, TextForPeople) {
  EXPECT_EQ(told_text({120, 300}, "line"), "line 120 of 300 (40 %)");
}

}  // namespace
}  // namespace packmerger
