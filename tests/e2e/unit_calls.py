"""The system calls of the daemon and of all that it starts, and which of them a unit's SystemCallFilter= lets through."""
import re
import subprocess

# Seen with strace -f as a user who is not root: a model uploaded and printed over a pseudo-terminal with Marlin, one dropped,
# sliced and printed over another as x3g (gpx), one packed and handed over; state and events read over HTTP, a reload, the end.
SEEN = """
accept4 access arch_prctl bind brk chdir chmod clock_gettime clock_nanosleep clone clone3 close dup2 eventfd2 execve
fchmod fcntl fdatasync flock fsync ftruncate futex getcwd getdents64 geteuid getpid getppid getpriority getrandom
getsockname getsockopt getuid inotify_add_watch inotify_init1 ioctl kill listen lseek lstat madvise memfd_create mkdir
mmap mprotect munmap newfstatat openat pipe2 poll prctl pread64 prlimit64 pwrite64 read readlink recvfrom rename
renameat2 restart_syscall rmdir rseq rt_sigaction rt_sigprocmask sched_getaffinity sched_setaffinity sched_yield
set_robust_list set_tid_address setpgid setpriority setsid setsockopt signalfd4 socket statfs statx sysinfo
timerfd_create uname unlink unlinkat wait4 write
""".split()

# What confines the processes that read models (base/process/confinement.cpp).
CONFINING = "landlock_create_ruleset landlock_add_rule landlock_restrict_self seccomp prctl".split()

# What another run may need: clients and servers of sockets and links, an abort's signal, the end of a process.
OTHERS = "connect exit exit_group rt_sigreturn sendmsg sendto recvmsg shutdown tgkill timerfd_settime".split()

NEEDED = frozenset(SEEN + CONFINING + OTHERS)


def members(group):
    """The calls of a group as systemd-analyze tells them, groups within it included."""
    told = subprocess.run(["systemd-analyze", "syscall-filter", "--no-pager", group],
                          capture_output=True, text=True, check=True).stdout
    names = {line.split()[0] for line in told.splitlines()[1:] if line.strip() and not line.strip().startswith("#")}
    return set().union(*(expand(name) for name in names))


def expand(name):
    return members(name) if name.startswith("@") else {name}


def allowed(unit):
    """What the unit's lines let through, read in their order as systemd does: the first is a list of what is allowed."""
    calls = set()
    for text in re.findall(r"^SystemCallFilter=(.*)$", unit, re.MULTILINE):
        named = set().union(*(expand(name) for name in text.lstrip("~").split()))
        calls = calls - named if text.startswith("~") else calls | named
    return calls
