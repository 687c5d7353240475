#include "base/files.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

#include "base/error.h"
#include "fixtures/fault_of.h"

namespace packmerger {
namespace {

using fixtures::fault_of;

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

TEST(Files, WhatIsWrittenIsRead) {
  const TemporaryFolder folder;
  std::string bytes("\0\n\r\xff", 4);
  for (int i = 0; i < 20; ++i) bytes += bytes;  // 4 MiB
  write_file_whole(folder.path() / "a", bytes);
  EXPECT_EQ(read_file(folder.path() / "a", bytes.size()), bytes);
  EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(Files, ReplacingKeepsTheOldOnFailure) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "taken");  // a folder cannot be replaced by a file
  EXPECT_EQ(fault_of([&] { write_file_whole(folder.path() / "taken", "new"); }),
            Fault::kCannotWrite);
  EXPECT_TRUE(fs::is_directory(folder.path() / "taken"));
  EXPECT_EQ(entries(folder.path()), 1u) << "no temporary file is left";
}

// A limit on a file's size stands in for the full disk: write() fails half-way in both.
TEST(Files, AFullDiskLeavesTheOldFileAndNothingElse) {
  const TemporaryFolder folder;
  write_file_whole(folder.path() / "job", "old");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = ::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1 << 20, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string bytes(std::size_t{3} << 20, 'x');
  EXPECT_EQ(fault_of([&] { write_file_whole(folder.path() / "job", bytes); }), Fault::kCannotWrite);
  EXPECT_EQ(fault_of([&] { write_file_whole(folder.path() / "new", bytes); }), Fault::kCannotWrite);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  ::signal(SIGXFSZ, handler);
  EXPECT_EQ(read_file(folder.path() / "job", 10), "old");
  EXPECT_EQ(entries(folder.path()), 1u) << "no half-written file is left";
}

TEST(Files, RefusesWhatIsTooLargeMissingOrAFolder) {
  const TemporaryFolder folder;
  write_file_whole(folder.path() / "big", std::string(1000, 'x'));
  EXPECT_EQ(fault_of([&] { read_file(folder.path() / "big", 999); }), Fault::kBadInput);
  EXPECT_EQ(fault_of([&] { read_file(folder.path() / "none", 999); }), Fault::kNoInput);
  EXPECT_EQ(fault_of([&] { read_file(folder.path(), 999); }), Fault::kNoInput);
  EXPECT_EQ(fault_of([] { read_file("/dev/zero", 1 << 20); }), Fault::kNoInput);
  ASSERT_EQ(::mkfifo((folder.path() / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(fault_of([&] { read_file(folder.path() / "pipe", 999); }), Fault::kNoInput);
}

TEST(Files, Sha256OfKnownStrings) {
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  const TemporaryFolder folder;
  write_file_whole(folder.path() / "abc", "abc");
  EXPECT_EQ(sha256_hex_of_file(folder.path() / "abc"), sha256_hex("abc"));
}

TEST(TemporaryFolder, IsRemovedUnlessPublished) {
  const TemporaryFolder home;
  fs::path left;
  {
    TemporaryFolder draft = TemporaryFolder::beside(home.path() / "job");
    left = draft.path();
    write_file_whole(left / "inside", "x");
  }
  EXPECT_FALSE(fs::exists(left));
  TemporaryFolder draft = TemporaryFolder::beside(home.path() / "job");
  write_file_whole(draft.path() / "inside", "x");
  draft.publish(home.path() / "job");
  EXPECT_EQ(read_file(home.path() / "job" / "inside", 10), "x");
  EXPECT_EQ(entries(home.path()), 1u);
}

TEST(TemporaryFolder, NeverReplacesWhatIsThere) {
  const TemporaryFolder home;
  fs::create_directory(home.path() / "job");
  TemporaryFolder draft = TemporaryFolder::beside(home.path() / "job");
  EXPECT_EQ(fault_of([&] { draft.publish(home.path() / "job"); }), Fault::kCannotWrite);
  EXPECT_TRUE(fs::is_empty(home.path() / "job"));
}

TEST(TemporaryFolder, MissingParentIsToldAsSuch) {
  EXPECT_EQ(fault_of([] { TemporaryFolder::beside("/nonexistent/folder/job"); }),
            Fault::kCannotWrite);
}

}  // namespace
}  // namespace packmerger
