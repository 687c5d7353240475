// For what is preloaded into a program: the call that is replaced, the file behind a descriptor, and how a test hears of
// a call. Include it first: the library's own names are wanted.
#pragma once
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <unistd.h>

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

/* The mode that comes with O_CREAT. */
#define MODE_OF(flags)                            \
  mode_t mode = 0;                                \
  if (((flags) & (O_CREAT | __O_TMPFILE)) != 0) { \
    va_list more;                                 \
    va_start(more, flags);                        \
    mode = va_arg(more, mode_t);                  \
    va_end(more);                                 \
  }

/* 0 where the system does not tell. path takes PATH_MAX bytes; errno stays. */
static inline int find_path(int fd, char* path) {
  char link[64];
  const int before = errno;
  snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t size = readlink(link, path, PATH_MAX - 1);
  errno = before;
  if (size <= 0) return 0;
  path[size] = 0;
  return 1;
}

/* One byte more in the file that this variable names, by calls that nobody replaces. */
static inline void tell_test(const char* variable) {
  const char* told = getenv(variable);
  const int note = told == NULL ? -1 : (int)syscall(SYS_openat, AT_FDCWD, told, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600);
  if (note < 0) return;
  syscall(SYS_write, note, "x", 1);
  close(note);
}
