"""The filter of system calls lets a process compute and use its two pipes, and kills it for anything more."""

from __future__ import annotations

import os
import platform
import signal
import struct
import subprocess
import sys

import pytest

from coral.contact.cost_program.seccomp import ALLOW, KILL, MACHINES, REFUSE, available, filter_program

LINUX = sys.platform.startswith("linux")


@pytest.mark.skipif(not LINUX or platform.machine() not in MACHINES, reason="the machine has no such filter")
@pytest.mark.parametrize(
    "code",
    [
        "open('/etc/hostname')",
        "import os; os.fork()",
        "import socket; socket.socket()",
        "import os; os.execv('/bin/true', ['true'])",
        "import os; os.kill(1, 0)",
        "import os; os.read(5, 1)",
        "import os; os.write(2, b'x')",
        "import mmap; mmap.mmap(-1, 4096, prot=mmap.PROT_READ | 4)",
    ],
)
def test_the_filter_kills_what_reaches_for_more(code):
    script = (
        "import os, socket, mmap\nfrom coral.contact.cost_program.seccomp import install\n"
        f"install() or os._exit(77)\n{code}"
    )
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        check=False,
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
    )
    if done.returncode == 77:
        pytest.skip("the kernel has no such filter")
    assert done.returncode == -signal.SIGSYS


def instructions(machine):
    return list(struct.iter_unpack("HBBI", filter_program(MACHINES[machine])))


def verdict(machine, number, arguments=(0, 0, 0), arch=None):
    """What the filter answers to a system call: its instructions, run one by one."""
    arch = MACHINES[machine].arch if arch is None else arch
    data = {0: number, 4: arch, 16: arguments[0], 32: arguments[2]}
    code, at, held = instructions(machine), 0, 0
    while True:
        kind, met, unmet, value = code[at]
        if kind == 0x06:
            return value
        if kind == 0x20:
            held, at = data[value], at + 1
            continue
        holds = {0x15: held == value, 0x35: held >= value, 0x45: bool(held & value)}[kind]
        at += 1 + (met if holds else unmet)


@pytest.mark.parametrize("machine", sorted(MACHINES))
def test_reading_and_writing_are_allowed_on_one_descriptor_each(machine):
    calls = MACHINES[machine]
    assert verdict(machine, calls.read, (0, 0, 0)) == ALLOW
    assert verdict(machine, calls.write, (1, 0, 0)) == ALLOW
    assert verdict(machine, calls.read, (5, 0, 0)) == verdict(machine, calls.write, (2, 0, 0)) == KILL


@pytest.mark.parametrize("machine", sorted(MACHINES))
def test_memory_is_allowed_unless_it_can_be_executed(machine):
    for number in MACHINES[machine].memory:
        assert verdict(machine, number, (0, 0, 3)) == ALLOW
        assert verdict(machine, number, (0, 0, 7)) == KILL


@pytest.mark.parametrize("machine", sorted(MACHINES))
def test_calls_of_the_lists_get_their_answer_and_unknown_ones_are_refused(machine):
    calls = MACHINES[machine]
    assert {verdict(machine, number) for number in calls.free} == {ALLOW}
    assert {verdict(machine, number) for number in calls.fatal} == {KILL}
    assert verdict(machine, 9999) == REFUSE


@pytest.mark.parametrize("machine", sorted(MACHINES))
def test_a_call_of_another_architecture_is_killed(machine):
    assert verdict(machine, MACHINES[machine].free[0], arch=0x40000003) == KILL


def test_the_x32_numbers_of_allowed_calls_are_killed():
    assert verdict("x86_64", 0x40000000 + MACHINES["x86_64"].read) == KILL


@pytest.mark.parametrize("machine", sorted(MACHINES))
def test_every_jump_of_the_filter_stays_inside(machine):
    code = instructions(machine)
    for i, (kind, met, unmet, _) in enumerate(code):
        if kind & 0x07 == 0x05:
            assert i + 1 + max(met, unmet) < len(code)
    assert code[-1][0] == 0x06


@pytest.mark.skipif(not LINUX, reason="threads are counted on Linux")
def test_a_process_with_a_second_thread_is_not_filtered():
    script = (
        "import threading; from coral.contact.cost_program.seccomp import available; alone = available()\n"
        "done = threading.Event(); threading.Thread(target=done.wait).start()\n"
        "print(alone, available()); done.set()"
    )
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
    )
    assert done.stdout.split() == [str(platform.machine() in MACHINES), "False"]


def test_an_unknown_machine_is_not_filtered(monkeypatch):
    monkeypatch.setattr(platform, "machine", lambda: "sparc")
    assert not available()
