import os
import signal

import pytest

from coral.interrupts import Terminated
from coral.run_loop import run_to_end, stoppable, timing_of


class Run:
    """Ends by itself after five steps."""

    steps, end_reason = 0, ""

    def advance(self):
        self.steps += 1
        if self.steps == 5:
            self.end_reason = "done"


class Watch:
    """Asks to stop after a number of steps."""

    def __init__(self, stop_at=99):
        self.seen, self.stop_at = [], stop_at

    def tick(self, run):
        self.seen.append(run.steps)

    def stop_requested(self):
        return "stopped in the live view" if len(self.seen) >= self.stop_at else ""


def test_every_observer_sees_every_step_of_a_run_to_its_end():
    run, watches = Run(), [Watch(), Watch()]
    run_to_end(run, watches)
    assert run.end_reason == "done"
    assert [watch.seen for watch in watches] == [[1, 2, 3, 4, 5]] * 2


def test_an_observer_stops_a_run_but_does_not_rename_its_own_end():
    run, later = Run(), Watch()
    run_to_end(run, [Watch(stop_at=2), later])
    assert (run.end_reason, later.seen) == ("stopped in the live view", [1, 2])
    run = Run()
    run_to_end(run, [Watch(stop_at=5)])
    assert run.end_reason == "done"


@pytest.mark.parametrize(
    ("stop", "reason"), [(KeyboardInterrupt(), "stopped by the operator"), (Terminated(15), "stopped by SIGTERM")]
)
def test_an_interrupt_is_an_end_reason(stop, reason):
    run = Run()
    with stoppable(run):
        raise stop
    assert run.end_reason == reason


@pytest.fixture
def heard_interrupts():
    """Python's handler of Ctrl-C, which a process that began in the background does not have."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_an_interrupt_in_a_step_waits_for_its_end(heard_interrupts):
    class Interrupted(Run):
        whole = 0

        def advance(self):
            super().advance()
            if self.steps == 2:
                os.kill(os.getpid(), signal.SIGINT)
            self.whole += 1

    run = Interrupted()
    with stoppable(run):
        run_to_end(run, [])
    assert (run.steps, run.whole, run.end_reason) == (2, 2, "stopped by the operator")


def test_timing_by_hand():
    samples = [float(ms) for ms in range(101)]
    assert timing_of(2.0, 5.0, plan_ms=samples) == {
        "wall_time_s": 2.0,
        "realtime_factor": 2.5,
        "plan_ms_median": 50.0,
        "plan_ms_p99": 99.0,
    }
    assert timing_of(0.0, 5.0, plan_ms=[]) == dict.fromkeys(
        ("wall_time_s", "realtime_factor", "plan_ms_median", "plan_ms_p99"), 0.0
    )
