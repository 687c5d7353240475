// What a confined child tries is refused; what it needs is not.
#include "base/confinement.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/error.h"
#include "base/files.h"
#include "base/process.h"

namespace packmerger {
namespace {

namespace fs = std::filesystem;

class ConfinementTest : public ::testing::Test {
 protected:
  ConfinementTest() {
    fs::create_directories(own_ / "deep");
    std::ofstream(outside_) << "whole";
  }

  bool succeeds(const std::vector<std::string>& argv) {
    ProcessSpec spec;
    spec.argv = argv;
    spec.folder = own_;
    spec.only_writable = {own_};
    return run_process(spec, 60, Progress()).status.ok();
  }
  bool shell(const std::string& script) { return succeeds({"/bin/sh", "-c", script}); }
  bool python(const std::string& script) { return succeeds({"/usr/bin/python3", "-c", script}); }
  std::string outside() const { return read_file(outside_, 100); }

  const TemporaryFolder holder_;
  fs::path folder_ = holder_.path();
  fs::path own_ = folder_ / "own";
  fs::path outside_ = folder_ / "outside";
};

TEST_F(ConfinementTest, ItsOwnFolderIsItsOwn) {
  EXPECT_TRUE(shell("echo a > a && mkdir d && mv a d/b && mv d/b deep/c && rm -r d"));
  EXPECT_TRUE(shell("cat ../outside > copy && test \"$(cat copy)\" = whole")) << "it may read";
  EXPECT_TRUE(shell("echo gone > /dev/null"));
  EXPECT_TRUE(shell("sh -c 'exec sleep 0.01' & wait $!"));
}

TEST_F(ConfinementTest, NothingElseIsWritten) {
  if (!can_confine_files()) GTEST_SKIP() << "this kernel has no Landlock";
  for (const char* attempt :
       {"echo x > ../outside", "echo x >> ../outside", "rm ../outside", "mv ../outside .",
        "echo x > ../new", "mkdir ../new", "ln -s . ../new", "mkfifo ../new",
        "truncate -s 0 ../outside", "ln -s ../outside a && echo x > a",
        "ln ../outside b && echo x > b", "cp /bin/true ../new", "sh -c 'echo x > ../outside'"})
    EXPECT_FALSE(shell(attempt)) << attempt;
  EXPECT_EQ(outside(), "whole");
  EXPECT_FALSE(fs::exists(folder_ / "new"));
}

TEST_F(ConfinementTest, NoSocketsOfAnyKind) {
  for (const char* family : {"AF_INET", "AF_INET6", "AF_UNIX", "AF_NETLINK"})
    EXPECT_TRUE(
        python("import socket, sys\n"
               "try:\n socket.socket(socket." +
               std::string(family) +
               ", socket.SOCK_DGRAM)\n"
               "except PermissionError: sys.exit(0)\n"
               "sys.exit(1)"))
        << family;
}

TEST_F(ConfinementTest, NoWayIntoOtherProcesses) {
  EXPECT_TRUE(
      python("import ctypes, os, sys\n"
             "libc = ctypes.CDLL(None, use_errno=True)\n"
             "sys.exit(0 if libc.ptrace(16, os.getppid(), 0, 0) == -1 and ctypes.get_errno() == 13 "
             "else 1)"));
  EXPECT_FALSE(shell("unshare -r true"));
}

// Its own file is within reach of Landlock, whatever the kernel: here seccomp refuses.
TEST_F(ConfinementTest, SeccompRefusesWhatLandlockDoesNotKnow) {
  ASSERT_TRUE(shell("echo own > own"));
  for (const char* attempt :
       {"libc.truncate(b'own', 0)", "libc.chown(b'own', -1, -1)", "libc.utimes(b'own', None)",
        "libc.setxattr(b'own', b'user.a', b'b', 1, 0)", "libc.removexattr(b'own', b'user.a')"})
    EXPECT_TRUE(
        python("import ctypes, sys\n"
               "libc = ctypes.CDLL(None, use_errno=True)\n"
               "refused = " +
               std::string(attempt) +
               " == -1 and ctypes.get_errno() == 13\n"
               "sys.exit(0 if refused else 1)"))
        << attempt;
}

TEST_F(ConfinementTest, AFolderThatIsNotThereIsTold) {
  ProcessSpec spec;
  spec.argv = {"/bin/true"};
  spec.only_writable = {folder_ / "missing"};
  if (!can_confine_files()) GTEST_SKIP() << "this kernel has no Landlock";
  EXPECT_THROW(run_process(spec, 60, Progress()), Error);
}

}  // namespace
}  // namespace packmerger
