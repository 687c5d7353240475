// What a confined child tries is refused; what it needs is not.
#include "base/process/confinement.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <regex>

#include "base/error.h"
#include "base/files.h"
#include "base/process/process.h"

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
  // Whether a call of the C library is refused as the filter refuses it.
  bool refused(const std::string& call) {
    return python(
        "import ctypes, os, struct, sys\n"
        "libc = ctypes.CDLL(None, use_errno=True)\n"
        "sys.exit(0 if " +
        call + " == -1 and ctypes.get_errno() == 13 else 1)");
  }
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
  EXPECT_TRUE(refused("libc.ptrace(16, os.getppid(), 0, 0)"));
  EXPECT_FALSE(shell("unshare -r true"));
  const std::string new_user_and_sigchld = "0x10000011";
  EXPECT_TRUE(refused("libc.syscall(56, " + new_user_and_sigchld + ", 0, 0, 0, 0)"));
}

// Its own file is within reach of Landlock, whatever the kernel: here seccomp refuses.
TEST_F(ConfinementTest, SeccompRefusesWhatLandlockDoesNotKnow) {
  ASSERT_TRUE(shell("echo own > own"));
  for (const char* attempt :
       {"libc.truncate(b'own', 0)", "libc.chmod(b'own', 0o777)",
        "libc.fchmod(os.open('own', os.O_RDONLY), 0o777)", "libc.fchmodat(-100, b'own', 0o777, 0)",
        "libc.syscall(452, -100, b'own', 0o777, 0)", "libc.chown(b'own', -1, -1)",
        "libc.utimes(b'own', None)", "libc.setxattr(b'own', b'user.a', b'b', 1, 0)",
        "libc.ioctl(os.open('../outside', os.O_RDONLY), 0x40086602, struct.pack('l', 0x80))",
        "libc.removexattr(b'own', b'user.a')", "libc.syscall(425, 8, bytes(120))"})
    EXPECT_TRUE(refused(attempt)) << attempt;
}

TEST_F(ConfinementTest, TheModeOfAFileOutsideStays) {
  fs::permissions(outside_, fs::perms::owner_read);
  EXPECT_FALSE(shell("chmod 777 ../outside"));
  EXPECT_FALSE(python("import os; os.truncate('../outside', 0)"));
  EXPECT_EQ(fs::status(outside_).permissions(), fs::perms::owner_read);
  EXPECT_EQ(outside(), "whole");
}

// Every way there is to signal a process of the same user, and to end or starve it otherwise.
TEST_F(ConfinementTest, NobodyOutsideIsSignalled) {
  const pid_t victim = ::fork();
  if (victim == 0) {
    ::pause();
    ::_exit(0);
  }
  const std::string pid = std::to_string(victim);
  for (const char* attempt :
       {"libc.kill(PID, 9)", "libc.kill(-os.getpgid(PID), 9)", "libc.kill(-1, 9)",
        "libc.syscall(200, PID, 9)", "libc.syscall(234, PID, PID, 9)",
        "libc.syscall(129, PID, 9, bytes(128))", "libc.syscall(297, PID, PID, 9, bytes(128))",
        "libc.syscall(434, PID, 0)",
        "libc.syscall(424, os.open('/proc/PID', os.O_RDONLY), 9, 0, 0)", "libc.fcntl(0, 8, PID)",
        "libc.fcntl(0, 10, 9)", "libc.fcntl(0, 15, struct.pack('ii', 1, PID))",
        "libc.prlimit(PID, 0, struct.pack('QQ', 0, 0), None)", "libc.setpriority(0, PID, 19)",
        "libc.syscall(251, 1, PID, 0x6000)", "libc.sched_setaffinity(PID, 8, struct.pack('Q', 1))"})
    EXPECT_TRUE(refused(std::regex_replace(std::string(attempt), std::regex("PID"), pid)))
        << attempt;
  EXPECT_FALSE(python("import os; os.setpgid(0, os.getpgid(" + pid + "))"))
      << "a group of another session";
  EXPECT_EQ(::waitpid(victim, nullptr, WNOHANG), 0) << "it still lives";
  ::kill(victim, SIGKILL);
  ::waitpid(victim, nullptr, 0);
}

TEST_F(ConfinementTest, WhoGivesUpIsToldAsSuch) {
  ProcessSpec spec;
  spec.argv = {"/usr/bin/python3", "-c", "import os; os.abort()"};
  spec.folder = own_;
  spec.only_writable = {own_};
  EXPECT_EQ(run_process(spec, 60, Progress()).status.signal, SIGABRT);
  EXPECT_TRUE(refused("libc.gsignal(15)")) << "no other signal";
  EXPECT_TRUE(refused("libc.syscall(234, os.getppid(), os.getppid(), 6)")) << "nor another process";
}

TEST_F(ConfinementTest, NoDeviceIsOpened) {
  if (!can_confine_files()) GTEST_SKIP() << "this kernel has no Landlock";
  EXPECT_TRUE(shell("head -c 1 /dev/urandom > own"));
  EXPECT_TRUE(shell("! cat < /dev/ptmx & sleep 0.01; wait $!"));
}

// As prepare ends its slicer: the whole group of a child, though it may signal no other than its
// own.
TEST_F(ConfinementTest, ItsOwnChildrenAreEnded) {
  const pid_t confined = ::fork();
  if (confined == 0) {
    if (!Confinement({own_}).apply()) ::_exit(1);
    ProcessSpec spec;
    spec.argv = {"/bin/sh", "-c", "sleep 1000 & echo; wait"};
    const auto begin = std::chrono::steady_clock::now();
    const ProcessResult result = run_process(spec, 0.2, Progress());
    const bool soon = std::chrono::steady_clock::now() - begin < std::chrono::seconds(100);
    ::_exit(result.timed_out && result.status.signal == SIGTERM && soon ? 0 : 2);
  }
  int status = -1;
  ::waitpid(confined, &status, 0);
  EXPECT_EQ(status, 0);
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
