import gc
import sys

import pytest

from coral.reef.sea.real_time import (
    RealTicks,
    little_garbage,
    prompt_threads,
)


class FakeClock:
    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now

    def sleep(self, seconds):
        self.now += seconds + 0.0003  # a real sleep ends a little late


def run(clock, works):
    loop = RealTicks(0.1, clock, clock.sleep)
    times = []
    for work in works:
        times.append(loop.wait())
        clock.now += work
        loop.finish()
    return loop, times


def test_deadlines_do_not_drift():
    clock = FakeClock()
    loop, times = run(clock, [0.03] * 1000)
    assert times == pytest.approx([0.1 * k for k in range(1000)])
    assert (loop.done, loop.late, loop.skipped) == (1000, 0, 0)


def test_a_slow_tick_is_late_and_what_passed_meanwhile_is_left_out():
    clock = FakeClock()
    loop, times = run(clock, [0.02, 0.35, 0.02, 0.02])
    # The second tick is due at 0.1 and ends at 0.45: those of 0.2 and 0.3 are left out, that of 0.4 runs at once.
    assert times == pytest.approx([0.0, 0.1, 0.4, 0.5])
    assert loop.skipped == 2
    assert loop.late == 3


def test_after_a_delay_there_is_no_burst():
    clock = FakeClock()
    _, times = run(clock, [2.05] + [0.01] * 5)
    assert times[1:] == pytest.approx([2.0, 2.1, 2.2, 2.3, 2.4])


def test_a_tick_that_ends_within_the_next_period_is_not_late():
    clock = FakeClock()
    loop, _ = run(clock, [0.099, 0.099])
    assert loop.late == 0
    assert max(loop.ends_s) == pytest.approx(0.099, abs=1e-3)


def test_the_time_since_the_deadline_is_told():
    clock = FakeClock()
    loop = RealTicks(0.1, clock, clock.sleep)
    loop.wait()
    clock.now += 0.03
    assert loop.finish() == pytest.approx(0.03)


@pytest.mark.parametrize(("frozen", "after"), [(0, ["unfreeze"]), (9, [])])
def test_what_exists_is_no_garbage_inside_and_as_before_after(monkeypatch, frozen, after):
    done = []
    for name in ("collect", "freeze", "unfreeze"):
        monkeypatch.setattr(gc, name, lambda name=name: done.append(name))
    monkeypatch.setattr(gc, "get_freeze_count", lambda: frozen)
    with little_garbage():
        assert done == ["collect", "freeze"]
    assert done[2:] == after


def test_threads_switch_faster_inside_and_as_before_after():
    found = sys.getswitchinterval()
    try:
        sys.setswitchinterval(0.005)
        with prompt_threads():
            assert sys.getswitchinterval() < 0.005
        assert sys.getswitchinterval() == pytest.approx(0.005)
    finally:
        sys.setswitchinterval(found)


def test_ticks_say_what_time_it_is_and_how_long_the_last_one_was():
    clock = FakeClock()
    ticks = RealTicks(0.1, clock, clock.sleep)
    assert ticks.start() == clock.now
    found = []
    for step in range(3):
        found.append(ticks.begin(step))
        clock.now += 0.13 if step == 0 else 0.02
        ticks.finish()
        assert ticks.end(step + 1) == found[-1][0]
    assert found[0] == (0.0, 0.0)
    assert found[1] == pytest.approx((0.13, 0.13))
    assert found[2] == pytest.approx((0.2003, 0.0703), abs=1e-6)
