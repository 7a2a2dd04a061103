"""A system-call filter for the sandbox: it may compute, and use two open pipes."""

from __future__ import annotations

import ctypes
import os
import platform
import struct
import sys
from dataclasses import dataclass

PR_SET_NO_NEW_PRIVS, PR_SET_SECCOMP, SECCOMP_MODE_FILTER = 38, 22, 2
ALLOW, REFUSE, KILL = 0x7FFF0000, 0x00050001, 0x80000000  # REFUSE answers EPERM: the C library may try harmless calls
LOAD, JUMP_EQUAL, JUMP_SET, JUMP_ABOVE, RETURN = 0x20, 0x15, 0x45, 0x35, 0x06
ARCH_OFFSET, FIRST_ARGUMENT, THIRD_ARGUMENT = 4, 16, 32
PROT_EXEC = 4


@dataclass(frozen=True)
class Calls:
    """System call numbers of one machine architecture."""

    arch: int
    """The kernel's number for it."""
    read: int
    """May be called on file descriptor 0."""
    write: int
    """May be called on file descriptor 1."""
    memory: tuple[int, ...]
    """mmap and mprotect, allowed unless they ask for executable pages."""
    free: tuple[int, ...]
    """Allowed without conditions."""
    fatal: tuple[int, ...]
    """Kills the process at once: files, processes, network."""


MACHINES = {
    # free: close fstat lseek munmap brk rt_sigaction rt_sigprocmask rt_sigreturn sched_yield mremap madvise getitimer
    # setitimer getpid exit gettimeofday sigaltstack gettid futex clock_gettime exit_group getrandom rseq
    # fatal: open openat openat2 execve execveat fork vfork clone clone3 socket connect ptrace kill
    "x86_64": Calls(
        0xC000003E,
        0,
        1,
        (9, 10),
        (3, 5, 8, 11, 12, 13, 14, 15, 24, 25, 28, 36, 38, 39, 60, 96, 131, 186, 202, 228, 231, 318, 334),
        (2, 257, 437, 59, 322, 57, 58, 56, 435, 41, 42, 101, 62),
    ),
    "aarch64": Calls(
        0xC00000B7,
        63,
        64,
        (222, 226),
        (57, 80, 62, 215, 214, 134, 135, 139, 124, 216, 233, 102, 103, 172, 93, 169, 132, 178, 98, 113, 94, 278, 293),
        (56, 437, 221, 281, 220, 435, 198, 203, 117, 129),
    ),
}


def filter_program(calls: Calls) -> bytes:
    """Assemble the filter as BPF instructions, 8 bytes each."""
    code: list[tuple[int, int, int, int]] = [
        (LOAD, 0, 0, ARCH_OFFSET),
        (JUMP_EQUAL, 1, 0, calls.arch),
        (RETURN, 0, 0, KILL),
        (LOAD, 0, 0, 0),
    ]
    if calls.arch == MACHINES["x86_64"].arch:
        code += [(JUMP_ABOVE, 0, 1, 0x40000000), (RETURN, 0, 0, KILL)]  # the x32 numbers of the same calls
    checked = [
        (calls.read, FIRST_ARGUMENT, (JUMP_EQUAL, 0, 1, 0)),
        (calls.write, FIRST_ARGUMENT, (JUMP_EQUAL, 0, 1, 1)),
        *((number, THIRD_ARGUMENT, (JUMP_SET, 1, 0, PROT_EXEC)) for number in calls.memory),
    ]
    for number, argument, allowed in checked:
        code += [
            (JUMP_EQUAL, 0, 4, number),
            (LOAD, 0, 0, argument),
            allowed,
            (RETURN, 0, 0, ALLOW),
            (RETURN, 0, 0, KILL),
        ]
    for number in calls.free:
        code += [(JUMP_EQUAL, 0, 1, number), (RETURN, 0, 0, ALLOW)]
    for number in calls.fatal:
        code += [(JUMP_EQUAL, 0, 1, number), (RETURN, 0, 0, KILL)]
    code.append((RETURN, 0, 0, REFUSE))
    return b"".join(struct.pack("HBBI", *instruction) for instruction in code)


class _Program(ctypes.Structure):
    _fields_ = [("length", ctypes.c_ushort), ("instructions", ctypes.c_void_p)]


def available() -> bool:
    """Check that the architecture is known and only one thread runs, since a filter binds only its own thread."""
    return (
        sys.platform.startswith("linux") and platform.machine() in MACHINES and len(os.listdir("/proc/self/task")) == 1
    )


def install() -> bool:
    """Install the filter for this process permanently; return whether the kernel accepted it."""
    calls = MACHINES[platform.machine()]
    code = filter_program(calls)
    buffer = ctypes.create_string_buffer(code, len(code))
    program = _Program(len(code) // 8, ctypes.cast(buffer, ctypes.c_void_p))
    libc = ctypes.CDLL(None, use_errno=True)
    zero = ctypes.c_ulong(0)
    if libc.prctl(PR_SET_NO_NEW_PRIVS, ctypes.c_ulong(1), zero, zero, zero) != 0:
        return False
    return bool(libc.prctl(PR_SET_SECCOMP, ctypes.c_ulong(SECCOMP_MODE_FILTER), ctypes.byref(program), zero, zero) == 0)
