/* Preloaded into a program: what it writes, makes, renames or removes below a folder fails while a
 * file is there, as on a disk that is full or breaks. POSIX calls of the C library are replaced;
 * SQLite and the C++ library end in these.
 *   FAILING_DISK       the folder
 *   FAILING_DISK_WHEN  the file; its text: "FIRST COUNT ERRNO", calls counted from 1
 *   FAILING_DISK_TOLD  a file that gets one byte for each call that failed
 */
#include "real_call.h"

#include <stdatomic.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/uio.h>

static atomic_long calls;

static int lies_below(const char* path) {
  const char* folder = getenv("FAILING_DISK");
  char full[PATH_MAX];
  if (folder == NULL || path == NULL) return 0;
  if (path[0] != '/' && getcwd(full, sizeof full / 2) != NULL) {
    strncat(full, "/", 2);
    strncat(full, path, sizeof full - strlen(full) - 1);
    path = full;
  }
  return strncmp(path, folder, strlen(folder)) == 0;
}

/* 0, or the error with which this call fails. */
static int trouble(void) {
  char text[64] = "";
  long first = 0, count = 0;
  int cause = 0;
  const long number = atomic_fetch_add(&calls, 1) + 1;
  const char* when = getenv("FAILING_DISK_WHEN");
  const int file = when == NULL ? -1 : (int)syscall(SYS_openat, AT_FDCWD, when, O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  const ssize_t size = read(file, text, sizeof text - 1);
  close(file);
  if (size <= 0 || sscanf(text, "%ld %ld %d", &first, &count, &cause) != 3) return 0;
  if (number < first || number >= first + count) return 0;
  tell_test("FAILING_DISK_TOLD");
  return cause;
}

static int fails_at_path(const char* path) {
  const int before = errno;
  const int cause = lies_below(path) ? trouble() : 0;
  errno = cause != 0 ? cause : before;
  return cause != 0;
}

static int fails_at_fd(int fd) {
  char path[PATH_MAX];
  return find_path(fd, path) && fails_at_path(path);
}

ssize_t write(int fd, const void* data, size_t size) { return fails_at_fd(fd) ? -1 : REAL(write)(fd, data, size); }
ssize_t writev(int fd, const struct iovec* parts, int count) {
  return fails_at_fd(fd) ? -1 : REAL(writev)(fd, parts, count);
}
ssize_t pwrite(int fd, const void* data, size_t size, off_t at) {
  return fails_at_fd(fd) ? -1 : REAL(pwrite)(fd, data, size, at);
}
ssize_t pwrite64(int fd, const void* data, size_t size, off64_t at) {
  return fails_at_fd(fd) ? -1 : REAL(pwrite64)(fd, data, size, at);
}
int fsync(int fd) { return fails_at_fd(fd) ? -1 : REAL(fsync)(fd); }
int fdatasync(int fd) { return fails_at_fd(fd) ? -1 : REAL(fdatasync)(fd); }
int ftruncate(int fd, off_t size) { return fails_at_fd(fd) ? -1 : REAL(ftruncate)(fd, size); }
int ftruncate64(int fd, off64_t size) { return fails_at_fd(fd) ? -1 : REAL(ftruncate64)(fd, size); }
int rename(const char* from, const char* to) { return fails_at_path(to) ? -1 : REAL(rename)(from, to); }
int renameat2(int from_fd, const char* from, int to_fd, const char* to, unsigned flags) {
  return fails_at_path(to) ? -1 : REAL(renameat2)(from_fd, from, to_fd, to, flags);
}
int link(const char* from, const char* to) { return fails_at_path(to) ? -1 : REAL(link)(from, to); }
int unlink(const char* path) { return fails_at_path(path) ? -1 : REAL(unlink)(path); }
int mkdir(const char* path, mode_t mode) { return fails_at_path(path) ? -1 : REAL(mkdir)(path, mode); }
int mkostemp(char* name, int flags) { return fails_at_path(name) ? -1 : REAL(mkostemp)(name, flags); }

#define OPEN(name)                                           \
  int name(const char* path, int flags, ...) {               \
    MODE_OF(flags)                                           \
    if ((flags & O_CREAT) && fails_at_path(path)) return -1; \
    return REAL(name)(path, flags, mode);                    \
  }
OPEN(open)
OPEN(open64)
