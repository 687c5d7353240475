#include "base/process/confinement.h"

#include <fcntl.h>
#include <linux/filter.h>
#include <linux/fs.h>
#include <linux/fsverity.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <seccomp.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <memory>
#include <string>

#include "base/error.h"

namespace packmerger {
namespace {

constexpr std::uint64_t kRead = LANDLOCK_ACCESS_FS_READ_FILE;
constexpr std::uint64_t kWriteFile = LANDLOCK_ACCESS_FS_WRITE_FILE;
constexpr std::uint64_t kTruncate = std::uint64_t{1} << 14;  // ABI 3, newer than Debian's header
constexpr std::uint64_t kChange = kWriteFile | LANDLOCK_ACCESS_FS_REMOVE_DIR |
                                  LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_CHAR |
                                  LANDLOCK_ACCESS_FS_MAKE_DIR | LANDLOCK_ACCESS_FS_MAKE_REG |
                                  LANDLOCK_ACCESS_FS_MAKE_SOCK | LANDLOCK_ACCESS_FS_MAKE_FIFO |
                                  LANDLOCK_ACCESS_FS_MAKE_BLOCK | LANDLOCK_ACCESS_FS_MAKE_SYM;

[[noreturn]] void throw_refused(const std::string& what, int cause) {
  throw Error(Fault::kInternal, "Cannot confine a process (" + what + "): " + std::strerror(cause),
              "Run the program outside of a container that forbids seccomp or Landlock.");
}

// 0: the kernel has no Landlock, or it is switched off.
int landlock_abi() {
  const long abi =
      ::syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
  return abi < 0 ? 0 : static_cast<int>(abi);
}

// False, with errno set, where the place is not there or the kernel refuses.
bool allow_where_it_is(int ruleset, const std::filesystem::path& path, std::uint64_t access) {
  const Descriptor place(::open(path.c_str(), O_PATH | O_CLOEXEC));
  landlock_path_beneath_attr rule{};
  rule.allowed_access = access;
  rule.parent_fd = place.get();
  return place.get() >= 0 &&
         ::syscall(SYS_landlock_add_rule, ruleset, LANDLOCK_RULE_PATH_BENEATH, &rule, 0) == 0;
}

void allow(int ruleset, const std::filesystem::path& path, std::uint64_t access) {
  if (!allow_where_it_is(ruleset, path, access)) throw_refused(path.string(), errno);
}

Descriptor ruleset_for(const std::vector<std::filesystem::path>& writable) {
  const int abi = landlock_abi();
  if (abi == 0) return Descriptor();
  landlock_ruleset_attr attributes{};
  attributes.handled_access_fs =
      kRead | kChange | (abi >= 2 ? LANDLOCK_ACCESS_FS_REFER : 0) | (abi >= 3 ? kTruncate : 0);
  Descriptor ruleset(
      static_cast<int>(::syscall(SYS_landlock_create_ruleset, &attributes, sizeof attributes, 0)));
  if (ruleset.get() < 0) throw_refused("Landlock", errno);
  for (const auto& folder : writable) allow(ruleset.get(), folder, attributes.handled_access_fs);
  // Opening a serial port alone restarts many a printer. What cannot be opened now cannot be read.
  for (const auto& entry : std::filesystem::directory_iterator("/"))
    if (entry.path() != "/dev") allow_where_it_is(ruleset.get(), entry.path(), kRead);
  for (const char* harmless : {"/dev/null", "/dev/zero", "/dev/random", "/dev/urandom"})
    allow_where_it_is(ruleset.get(), harmless, kRead);
  allow(ruleset.get(), "/dev/null", attributes.handled_access_fs & (kWriteFile | kTruncate));
  return ruleset;
}

// Sockets of every kind, the daemon's own too, and what lets a process out of its place. Landlock
// has no say over modes, owners, times and attributes, over truncate(2) only since Linux 6.2, and
// over signals only since 6.12.
constexpr int kForbidden[] = {
    SCMP_SYS(truncate), SCMP_SYS(chmod), SCMP_SYS(fchmod), SCMP_SYS(fchmodat), SCMP_SYS(chown),
    SCMP_SYS(lchown), SCMP_SYS(fchown), SCMP_SYS(fchownat), SCMP_SYS(utime), SCMP_SYS(utimes),
    SCMP_SYS(futimesat), SCMP_SYS(utimensat), SCMP_SYS(setxattr), SCMP_SYS(lsetxattr),
    SCMP_SYS(fsetxattr), SCMP_SYS(removexattr), SCMP_SYS(lremovexattr), SCMP_SYS(fremovexattr),
    SCMP_SYS(socket), SCMP_SYS(io_uring_setup), SCMP_SYS(io_uring_enter),
    SCMP_SYS(io_uring_register), SCMP_SYS(tkill), SCMP_SYS(rt_sigqueueinfo),
    SCMP_SYS(rt_tgsigqueueinfo),
    // /proc/PID opened as a folder is one that pidfd_send_signal takes
    SCMP_SYS(pidfd_open), SCMP_SYS(pidfd_send_signal), SCMP_SYS(pidfd_getfd), SCMP_SYS(ptrace),
    SCMP_SYS(process_vm_readv), SCMP_SYS(process_vm_writev), SCMP_SYS(process_madvise),
    SCMP_SYS(mount), SCMP_SYS(umount2), SCMP_SYS(move_mount), SCMP_SYS(open_tree), SCMP_SYS(fsopen),
    SCMP_SYS(pivot_root), SCMP_SYS(chroot), SCMP_SYS(unshare), SCMP_SYS(setns), SCMP_SYS(bpf),
    SCMP_SYS(perf_event_open), SCMP_SYS(ioprio_set), SCMP_SYS(userfaultfd), SCMP_SYS(add_key),
    SCMP_SYS(request_key), SCMP_SYS(keyctl), SCMP_SYS(init_module), SCMP_SYS(finit_module),
    SCMP_SYS(delete_module), SCMP_SYS(kexec_load), SCMP_SYS(kexec_file_load), SCMP_SYS(reboot),
    SCMP_SYS(swapon), SCMP_SYS(swapoff), SCMP_SYS(settimeofday), SCMP_SYS(clock_settime),
    SCMP_SYS(adjtimex), SCMP_SYS(open_by_handle_at),
    // newer than Debian's libseccomp: fchmodat2, setxattrat, removexattrat, open_tree_attr,
    // file_setattr
    452, 463, 466, 467, 469};

struct ForbiddenArgument {
  int call;
  scmp_arg_cmp when;
};

// The kernel reads 32 bits of a command.
scmp_arg_cmp command(unsigned argument, std::uint32_t value) {
  return {argument, SCMP_CMP_MASKED_EQ, 0xffffffff, value};
}
scmp_arg_cmp not_zero(unsigned argument) { return {argument, SCMP_CMP_NE, 0, 0}; }

// Calls that are needed, but not on other processes.
std::vector<ForbiddenArgument> forbidden_arguments() {
  std::vector<ForbiddenArgument> result = {
      // 0 is the caller's own process group. Whom it may join is in its own session.
      {SCMP_SYS(kill), not_zero(0)},
      // 0 is the caller itself
      {SCMP_SYS(prlimit64), not_zero(0)},
      {SCMP_SYS(setpriority), not_zero(0)},
      {SCMP_SYS(setpriority), not_zero(1)},
      {SCMP_SYS(sched_setaffinity), not_zero(0)},
      {SCMP_SYS(sched_setscheduler), not_zero(0)},
      {SCMP_SYS(sched_setparam), not_zero(0)},
      {SCMP_SYS(sched_setattr), not_zero(0)},
      // a descriptor that becomes ready can send any signal to anybody
      {SCMP_SYS(fcntl), command(1, F_SETOWN)},
      {SCMP_SYS(fcntl), command(1, F_SETOWN_EX)},
      {SCMP_SYS(fcntl), command(1, F_SETSIG)},
      // types in the terminal that the daemon was started from
      // attributes, of whatever could be opened to be read
      {SCMP_SYS(ioctl), command(1, FS_IOC_SETFLAGS)},
      {SCMP_SYS(ioctl), command(1, FS_IOC32_SETFLAGS)},
      {SCMP_SYS(ioctl), command(1, FS_IOC_FSSETXATTR)},
      {SCMP_SYS(ioctl), command(1, FS_IOC_ENABLE_VERITY)},
      {SCMP_SYS(ioctl), command(1, TIOCSTI)},
      {SCMP_SYS(ioctl), command(1, TIOCLINUX)},
  };
  for (const std::uint64_t space : {CLONE_NEWUSER, CLONE_NEWNS, CLONE_NEWPID, CLONE_NEWNET,
                                    CLONE_NEWIPC, CLONE_NEWUTS, CLONE_NEWCGROUP})
    result.push_back({SCMP_SYS(clone), {0, SCMP_CMP_MASKED_EQ, space, space}});
  return result;
}

std::vector<char> filter_program() {
  const std::unique_ptr<void, decltype(&seccomp_release)> filter(seccomp_init(SCMP_ACT_ALLOW),
                                                                 seccomp_release);
  if (!filter) throw_refused("seccomp", ENOMEM);
  const auto check = [](int failed) {
    if (failed != 0) throw_refused("seccomp", -failed);
  };
  for (const int call : kForbidden)
    check(seccomp_rule_add(filter.get(), SCMP_ACT_ERRNO(EACCES), call, 0));
  for (const ForbiddenArgument& each : forbidden_arguments())
    check(seccomp_rule_add_array(filter.get(), SCMP_ACT_ERRNO(EACCES), each.call, 1, &each.when));
  // Its flags lie in memory, where a filter cannot look; the C library then takes clone.
  check(seccomp_rule_add(filter.get(), SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0));
  const Descriptor file(::memfd_create("packmerger-filter", MFD_CLOEXEC));
  if (file.get() < 0) throw_refused("seccomp", errno);
  if (const int failed = seccomp_export_bpf(filter.get(), file.get()); failed != 0)
    throw_refused("seccomp", -failed);
  std::vector<char> program(static_cast<std::size_t>(::lseek(file.get(), 0, SEEK_END)));
  if (::pread(file.get(), program.data(), program.size(), 0) !=
      static_cast<ssize_t>(program.size()))
    throw_refused("seccomp", errno);
  return program;
}

bool install(sock_filter* first, std::size_t count) {
  sock_fprog program{};
  program.len = static_cast<unsigned short>(count);
  program.filter = first;
  return ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program, 0, 0) == 0;
}

// Of tgkill, abort() of the caller itself alone, so that a program that gives up is told as one.
// Which process that is, is known only after the fork, so this is no rule of the filter above.
bool forbid_other_signals() {
  static_assert(std::endian::native == std::endian::little, "the low half of an argument is first");
  const auto argument = [](unsigned index) {
    return static_cast<unsigned>(offsetof(seccomp_data, args) + 8 * index);
  };
  sock_filter filter[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_tgkill, 0, 4),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, argument(0)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<unsigned>(::getpid()), 0, 3),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, argument(2)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SIGABRT, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EACCES),
  };
  return install(filter, sizeof filter / sizeof *filter);
}

}  // namespace

bool can_confine_files() { return landlock_abi() > 0; }

Confinement::Confinement(const std::vector<std::filesystem::path>& writable)
    : files_(ruleset_for(writable)), calls_(filter_program()) {}

bool Confinement::apply() const {
  if (::setsid() < 0) return false;
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return false;
  if (files_.get() >= 0 && ::syscall(SYS_landlock_restrict_self, files_.get(), 0) != 0)
    return false;
  auto* first = reinterpret_cast<sock_filter*>(const_cast<char*>(calls_.data()));
  return forbid_other_signals() && install(first, calls_.size() / sizeof(sock_filter));
}

}  // namespace packmerger
