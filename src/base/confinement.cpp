#include "base/confinement.h"

#include <fcntl.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <string>

#include "base/error.h"

namespace packmerger {
namespace {

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

void allow(int ruleset, const std::filesystem::path& path, std::uint64_t access) {
  const Descriptor place(::open(path.c_str(), O_PATH | O_CLOEXEC));
  landlock_path_beneath_attr rule{};
  rule.allowed_access = access;
  rule.parent_fd = place.get();
  if (place.get() < 0 ||
      ::syscall(SYS_landlock_add_rule, ruleset, LANDLOCK_RULE_PATH_BENEATH, &rule, 0) != 0)
    throw_refused(path.string(), errno);
}

Descriptor ruleset_for(const std::vector<std::filesystem::path>& writable) {
  const int abi = landlock_abi();
  if (abi == 0) return Descriptor();
  landlock_ruleset_attr attributes{};
  attributes.handled_access_fs =
      kChange | (abi >= 2 ? LANDLOCK_ACCESS_FS_REFER : 0) | (abi >= 3 ? kTruncate : 0);
  Descriptor ruleset(
      static_cast<int>(::syscall(SYS_landlock_create_ruleset, &attributes, sizeof attributes, 0)));
  if (ruleset.get() < 0) throw_refused("Landlock", errno);
  for (const auto& folder : writable) allow(ruleset.get(), folder, attributes.handled_access_fs);
  allow(ruleset.get(), "/dev/null", attributes.handled_access_fs & (kWriteFile | kTruncate));
  return ruleset;
}

// Sockets of every kind, the daemon's own too, and what lets a process out of its place.
// Landlock has no say over owners, times and attributes, and over truncate(2) only since Linux 6.2.
constexpr int kForbidden[] = {SCMP_SYS(truncate),
                              SCMP_SYS(chown),
                              SCMP_SYS(lchown),
                              SCMP_SYS(fchown),
                              SCMP_SYS(fchownat),
                              SCMP_SYS(utime),
                              SCMP_SYS(utimes),
                              SCMP_SYS(futimesat),
                              SCMP_SYS(utimensat),
                              SCMP_SYS(setxattr),
                              SCMP_SYS(lsetxattr),
                              SCMP_SYS(fsetxattr),
                              SCMP_SYS(removexattr),
                              SCMP_SYS(lremovexattr),
                              SCMP_SYS(fremovexattr),
                              SCMP_SYS(socket),
                              SCMP_SYS(io_uring_setup),
                              SCMP_SYS(ptrace),
                              SCMP_SYS(process_vm_readv),
                              SCMP_SYS(process_vm_writev),
                              SCMP_SYS(pidfd_getfd),
                              SCMP_SYS(mount),
                              SCMP_SYS(umount2),
                              SCMP_SYS(move_mount),
                              SCMP_SYS(open_tree),
                              SCMP_SYS(fsopen),
                              SCMP_SYS(pivot_root),
                              SCMP_SYS(chroot),
                              SCMP_SYS(unshare),
                              SCMP_SYS(setns),
                              SCMP_SYS(bpf),
                              SCMP_SYS(perf_event_open),
                              SCMP_SYS(userfaultfd),
                              SCMP_SYS(add_key),
                              SCMP_SYS(request_key),
                              SCMP_SYS(keyctl),
                              SCMP_SYS(init_module),
                              SCMP_SYS(finit_module),
                              SCMP_SYS(delete_module),
                              SCMP_SYS(kexec_load),
                              SCMP_SYS(kexec_file_load),
                              SCMP_SYS(reboot),
                              SCMP_SYS(swapon),
                              SCMP_SYS(swapoff),
                              SCMP_SYS(settimeofday),
                              SCMP_SYS(clock_settime),
                              SCMP_SYS(adjtimex),
                              SCMP_SYS(open_by_handle_at)};

std::vector<char> filter_program() {
  const std::unique_ptr<void, decltype(&seccomp_release)> filter(seccomp_init(SCMP_ACT_ALLOW),
                                                                 seccomp_release);
  if (!filter) throw_refused("seccomp", ENOMEM);
  for (const int call : kForbidden)
    if (const int failed = seccomp_rule_add(filter.get(), SCMP_ACT_ERRNO(EACCES), call, 0);
        failed != 0)
      throw_refused("seccomp", -failed);
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

}  // namespace

bool can_confine_files() { return landlock_abi() > 0; }

Confinement::Confinement(const std::vector<std::filesystem::path>& writable)
    : files_(ruleset_for(writable)), calls_(filter_program()) {}

bool Confinement::apply() const {
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return false;
  if (files_.get() >= 0 && ::syscall(SYS_landlock_restrict_self, files_.get(), 0) != 0)
    return false;
  sock_fprog program{};
  program.len = static_cast<unsigned short>(calls_.size() / sizeof(sock_filter));
  program.filter = reinterpret_cast<sock_filter*>(const_cast<char*>(calls_.data()));
  return ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program, 0, 0) == 0;
}

}  // namespace packmerger
