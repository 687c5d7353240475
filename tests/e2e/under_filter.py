#!/usr/bin/python3
"""Runs a program under a filter of system calls, as systemd runs a service: under_filter.py NAME[,NAME…] PROGRAM
ARGUMENTS…. Whoever makes another call, it or what it starts, is killed by SIGSYS."""
import ctypes
import os
import sys

KILL_PROCESS, ALLOW = 0x80000000, 0x7FFF0000  # SCMP_ACT_… of seccomp.h
UNKNOWN = -1                                  # __NR_SCMP_ERROR: a name of another architecture or a newer kernel


def confine(names):
    library = ctypes.CDLL("libseccomp.so.2")
    library.seccomp_init.restype = ctypes.c_void_p
    context = ctypes.c_void_p(library.seccomp_init(ctypes.c_uint32(KILL_PROCESS)))
    for name in names:
        number = library.seccomp_syscall_resolve_name(name.encode())
        if number != UNKNOWN and library.seccomp_rule_add(context, ctypes.c_uint32(ALLOW), number, 0) != 0:
            sys.exit(f"{name} cannot be allowed")
    if library.seccomp_load(context) != 0:
        sys.exit("the filter cannot be loaded")


confine(sys.argv[1].split(","))
os.execv(sys.argv[2], sys.argv[2:])
