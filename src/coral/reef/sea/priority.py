"""Priority for the program and its control thread, where the system allows it."""

from __future__ import annotations

import os
from contextlib import suppress

NICE = -10
REAL_TIME = 10
"""Of 99: above all ordinary programs, below the threads of drivers."""


def prefer_process() -> bool:
    """Let this program go before ordinary ones, threads that start later included. Return whether it was allowed."""
    with suppress(OSError, AttributeError):
        os.setpriority(os.PRIO_PROCESS, 0, NICE)
        return True
    return False


def prefer_thread() -> bool:
    """Let the calling thread go before all ordinary programs (SCHED_RR). Return whether it was allowed.

    Linux keeps 5 % of the time for the others, so that a thread that runs wild does not stop the machine.
    """
    with suppress(OSError, AttributeError):
        os.sched_setscheduler(0, os.SCHED_RR | os.SCHED_RESET_ON_FORK, os.sched_param(REAL_TIME))
        return True
    return False


def describe_priority(process: bool, thread: bool) -> str:
    """Return in words what was allowed."""
    if thread:
        return "real time" if process else "real time for control alone"
    return f"nice {NICE}" if process else "ordinary"
