#include "base/storage/move_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "base/error.h"
#include "daemon/intake/beside.h"
#include "fixtures/fault_of.h"

namespace packmerger {
namespace {

using fixtures::fault_of;

void write(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }

// A folder on another file system than the temporary one; empty where there is none.
fs::path other_file_system(const TemporaryFolder& folder) {
  struct stat here {};
  struct stat there {};
  ::stat(folder.path().c_str(), &here);
  if (::stat("/dev/shm", &there) != 0 || here.st_dev == there.st_dev) return {};
  return "/dev/shm";
}

TEST(MoveFile, NeverReplacesAFile) {
  const TemporaryFolder folder;
  write(folder.path() / "a", "new");
  write(folder.path() / "b", "old");
  EXPECT_EQ(fault_of([&] { rename_new(folder.path() / "a", folder.path() / "b"); }), Fault::kBusy);
  EXPECT_EQ(fault_of([&] { copy_file_whole(folder.path() / "a", folder.path() / "b"); }),
            Fault::kBusy);
  EXPECT_EQ(read_file(folder.path() / "b", 100), "old");
  EXPECT_EQ(read_file(folder.path() / "a", 100), "new");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 2) << "nothing left behind";
  EXPECT_EQ(fault_of([&] { rename_new(folder.path() / "x", folder.path() / "y"); }),
            Fault::kNoInput);
}

TEST(MoveFile, CrossesFileSystems) {
  const TemporaryFolder folder;
  const fs::path other = other_file_system(folder);
  if (other.empty()) GTEST_SKIP() << "there is no second file system at /dev/shm";
  TemporaryFolder there = TemporaryFolder::beside(other / "packmerger-test");
  const std::string bytes(3000000, 'x');
  write(there.path() / "a", bytes);
  EXPECT_EQ(rename_new(there.path() / "a", folder.path() / "deep/a"), Moved::kOtherFileSystem);
  move_new(there.path() / "a", folder.path() / "deep/a");
  EXPECT_EQ(read_file(folder.path() / "deep/a", 1 << 30), bytes);
  EXPECT_FALSE(fs::exists(there.path() / "a"));
}

TEST(MoveFile, ASymbolicLinkIsNotFollowed) {
  const TemporaryFolder folder;
  fs::create_symlink("/etc/passwd", folder.path() / "link");
  EXPECT_ANY_THROW(copy_file_whole(folder.path() / "link", folder.path() / "copy"));
  EXPECT_FALSE(fs::exists(folder.path() / "copy"));
}

TEST(MoveFile, FreePathCountsUpAndStaysWithinTheLimits) {
  const TemporaryFolder folder;
  EXPECT_EQ(free_path(folder.path(), "a.stl"), folder.path() / "a.stl");
  write(folder.path() / "a.stl", "");
  write(folder.path() / "a (2).stl.reason.txt", "");
  EXPECT_EQ(free_path(folder.path(), "a.stl"), folder.path() / "a (3).stl");
  std::string name;
  while (name.size() < 251) name += "\xC3\xBC";
  name.resize(250);
  name += ".stl";
  const fs::path first = free_path(folder.path(), name);
  write(first, "");
  write(note_beside(first, ".reason.txt"), "");
  const fs::path second = free_path(folder.path(), name);
  write(second, "");
  EXPECT_NE(first, second);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 5);
}

}  // namespace
}  // namespace packmerger
