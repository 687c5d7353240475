#include "daemon/move_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "base/error.h"
#include "daemon/find_port.h"
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

TEST(MoveFile, MessagesHoldNoControlCharacters) {
  EXPECT_EQ(printable("a\nb\x1b[2J\xC3\xBC"), "a?b?[2J\xC3\xBC");
}

class FindPortTest : public testing::Test {
 protected:
  void add(const std::string& name, const std::string& vendor, const std::string& product) {
    const fs::path device = folder_.path() / "devices" / name;
    const fs::path interface = device / "1-1:1.0";
    fs::create_directories(interface / "tty" / name);
    fs::create_directories(sys());
    if (!vendor.empty()) write(device / "idVendor", vendor + "\n");
    if (!product.empty()) write(device / "idProduct", product + "\n");
    fs::create_directory_symlink(interface, interface / "tty" / name / "device");
    fs::create_directory_symlink(interface / "tty" / name, sys() / name);
  }
  fs::path sys() const { return folder_.path() / "class"; }
  TemporaryFolder folder_;
};

TEST_F(FindPortTest, FindsTheOneByItsUsbId) {
  add("ttyACM0", "23c1", "d314");
  add("ttyUSB0", "1a86", "7523");
  add("ttyS0", "", "");
  EXPECT_EQ(find_port({"23c1:d314", "23c1:b404"}, sys()), "/dev/ttyACM0");
  EXPECT_EQ(usb_id_of_port("/dev/ttyUSB0", sys()), "1a86:7523");
  EXPECT_EQ(usb_id_of_port("/dev/ttyS0", sys()), "");
  EXPECT_EQ(fault_of([&] { find_port({"0000:0000"}, sys()); }), Fault::kUnavailable);
  EXPECT_EQ(fault_of([&] { find_port({}, sys()); }), Fault::kUsage);
  EXPECT_EQ(fault_of([&] { check_port("/dev/ttyUSB0", {"23c1:d314"}, sys()); }),
            Fault::kUnavailable);
  check_port("/dev/ttyACM0", {"23c1:d314"}, sys());
  check_port("/dev/ttyS0", {"23c1:d314"}, sys());
  check_port("/dev/pts/0", {"23c1:d314"}, sys());
  add("ttyACM1", "23c1", "b404");
  EXPECT_EQ(fault_of([&] { find_port({"23c1:d314", "23c1:b404"}, sys()); }), Fault::kUsage);
}

}  // namespace
}  // namespace packmerger
