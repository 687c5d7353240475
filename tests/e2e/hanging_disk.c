/* Preloaded into a program: whoever looks at, opens, renames or removes anything below a folder waits for as long as a file
 * is there, as on a network share whose server is gone. POSIX calls of the C library are replaced; the C++ library ends in
 * these.
 *   HANGING_DISK       the folders, separated by ":"
 *   HANGING_DISK_WHEN  the file
 *   HANGING_DISK_TOLD  a file that gets one byte for each call that waits
 *   HANGING_DISK_ONLY  the one call that waits; where it is not set, all do
 */
#include "real_call.h"

#include <dirent.h>
#include <stdint.h>
#include <string.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <time.h>

static int lies_below(const char* path) {
  const char* folder = getenv("HANGING_DISK");
  if (path == NULL || path[0] != '/') return 0;
  while (folder != NULL && folder[0] != 0) {
    const size_t length = strcspn(folder, ":");
    if (length > 0 && strncmp(path, folder, length) == 0 && (path[length] == '/' || path[length] == 0)) return 1;
    folder += length + (folder[length] == ':');
  }
  return 0;
}

static int hangs(void) {
  const char* when = getenv("HANGING_DISK_WHEN");
  return when != NULL && syscall(SYS_faccessat, AT_FDCWD, when, F_OK) == 0;
}

static int is_meant(const char* call) {
  const char* only = getenv("HANGING_DISK_ONLY");
  return only == NULL || only[0] == 0 || strcmp(only, call) == 0;
}

static void wait_at_path(const char* call, const char* path) {
  const int before = errno;
  if (is_meant(call) && lies_below(path) && hangs()) {
    tell_test("HANGING_DISK_TOLD");
    const struct timespec pause = {0, 10 * 1000 * 1000};
    while (hangs()) nanosleep(&pause, NULL);
  }
  errno = before;
}

static void wait_at_fd(const char* call, int fd) {
  char path[PATH_MAX];
  if (find_path(fd, path)) wait_at_path(call, path);
}

#define AT_PATH(type, name, parameters, path, ...) \
  type name parameters {                           \
    wait_at_path(#name, path);                     \
    return REAL(name)(__VA_ARGS__);                \
  }

AT_PATH(int, stat, (const char* path, struct stat* status), path, path, status)
AT_PATH(int, lstat, (const char* path, struct stat* status), path, path, status)
AT_PATH(int, stat64, (const char* path, struct stat64* status), path, path, status)
AT_PATH(int, lstat64, (const char* path, struct stat64* status), path, path, status)
AT_PATH(int, fstatat, (int at, const char* path, struct stat* status, int flags), path, at, path, status, flags)
AT_PATH(int, mkdir, (const char* path, mode_t mode), path, path, mode)
AT_PATH(int, unlink, (const char* path), path, path)
AT_PATH(int, remove, (const char* path), path, path)
AT_PATH(int, inotify_add_watch, (int fd, const char* path, uint32_t mask), path, fd, path, mask)
AT_PATH(DIR*, opendir, (const char* path), path, path)
AT_PATH(FILE*, fopen, (const char* path, const char* mode), path, path, mode)
AT_PATH(FILE*, fopen64, (const char* path, const char* mode), path, path, mode)

struct dirent* readdir(DIR* folder) {
  wait_at_fd("readdir", dirfd(folder));
  return REAL(readdir)(folder);
}
struct dirent64* readdir64(DIR* folder) {
  wait_at_fd("readdir64", dirfd(folder));
  return REAL(readdir64)(folder);
}
ssize_t read(int fd, void* data, size_t size) {
  wait_at_fd("read", fd);
  return REAL(read)(fd, data, size);
}
int rename(const char* from, const char* to) {
  wait_at_path("rename", from);
  wait_at_path("rename", to);
  return REAL(rename)(from, to);
}
int renameat2(int at, const char* from, int to_at, const char* to, unsigned flags) {
  wait_at_path("renameat2", from);
  wait_at_path("renameat2", to);
  return REAL(renameat2)(at, from, to_at, to, flags);
}

int open(const char* path, int flags, ...) {
  MODE_OF(flags)
  wait_at_path("open", path);
  return REAL(open)(path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  MODE_OF(flags)
  wait_at_path("open64", path);
  return REAL(open64)(path, flags, mode);
}
int openat(int at, const char* path, int flags, ...) {
  MODE_OF(flags)
  wait_at_path("openat", path);
  return REAL(openat)(at, path, flags, mode);
}
