// Whoever works at a slow disk is not told as hanging: between two signs of life lies one call.
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <fstream>

#include "base/sign_of_life.h"
#include "base/storage/move_file.h"
#include "daemon/intake/folder_actions.h"
#include "daemon/orders/pulse.h"

namespace {

std::atomic<int> waits{0};       // calls for the disk since the last sign of life
std::atomic<int> most_waits{0};  // in a row
std::atomic<int> syncs{0};

int counted(long result) {
  ++syncs;
  most_waits = std::max(most_waits.load(), ++waits);
  return static_cast<int>(result);
}

}  // namespace

// In place of the C library's, for this program.
extern "C" int fsync(int fd) { return counted(::syscall(SYS_fsync, fd)); }
extern "C" int fdatasync(int fd) { return counted(::syscall(SYS_fdatasync, fd)); }

namespace packmerger {
namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20;

class SignsOfLife : public testing::Test {
 protected:
  SignsOfLife() { waits = most_waits = syncs = 0; }

  fs::path file(const std::string& name, std::size_t bytes) const {
    const fs::path path = folder_.path() / name;
    std::ofstream(path) << std::string(bytes, 'x');
    return path;
  }

  TemporaryFolder folder_;
  int signs_ = 0;
  AnswerListener listener_{[this] {
    ++signs_;
    waits = 0;
  }};
};

TEST_F(SignsOfLife, ACopyIsSyncedBitByBit) {
  const fs::path from = file("from", 20 * kMiB);
  copy_file_whole(from, folder_.path() / "to");
  EXPECT_GE(syncs, 4) << "no single call waits for all of it";
  EXPECT_EQ(most_waits, 1);
  EXPECT_EQ(read_file(folder_.path() / "to", 1 << 30), read_file(from, 1 << 30));
}

TEST_F(SignsOfLife, HashingTellsOfEachBlock) {
  const fs::path from = file("from", 4 * kMiB);
  sha256_hex_of_file(from);
  EXPECT_GE(signs_, 16);
}

TEST_F(SignsOfLife, PublishingTellsOfEachFile) {
  TemporaryFolder made = TemporaryFolder::beside(folder_.path() / "made");
  fs::create_directory(made.path() / "deep");
  for (const char* name : {"a", "b", "deep/c"}) std::ofstream(made.path() / name) << name;
  made.publish(folder_.path() / "made");
  EXPECT_EQ(syncs, 6) << "three files, two folders, and that around them";
  EXPECT_EQ(most_waits, 1);
}

TEST_F(SignsOfLife, FilingTellsOfEachCall) {
  FileOrder order;
  order.from = file("in.stl", 10);
  order.to = folder_.path() / "done/in.stl";
  order.picture = file("preview.png", 10);
  order.note = folder_.path() / "done/in.stl.result.json";
  order.note_text = "{}";
  EXPECT_FALSE(packmerger::file(order).failure);
  EXPECT_GE(syncs, 4);
  EXPECT_EQ(most_waits, 1);
}

TEST(Pulse, EachAnswerBeginsAnew) {
  Pulse pulse;
  EXPECT_FALSE(pulse.hangs_since(-1));
  {
    const Pulse::Stroke stroke(pulse);
    const std::optional<double> begun_s = pulse.hangs_since(-1);
    ASSERT_TRUE(begun_s);
    while (unix_now_s() <= *begun_s) {
    }
    disk_answered();
    EXPECT_GT(pulse.hangs_since(-1).value_or(0), *begun_s);
  }
  EXPECT_FALSE(pulse.hangs_since(-1));
  disk_answered();  // nobody watches any more
  EXPECT_FALSE(pulse.hangs_since(-1));
}

}  // namespace
}  // namespace packmerger
