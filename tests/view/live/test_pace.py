import pytest

from coral.view.live.pace import Pace


class Wall:
    def __init__(self):
        self.now, self.rests = 0.0, []

    def clock(self):
        return self.now

    def wait(self, seconds):
        self.rests.append(seconds)
        self.now += seconds


def test_a_speed_limit_holds_and_nothing_is_hurried():
    wall = Wall()
    pace = Pace(2.0, clock=wall.clock, wait=wall.wait)
    for k in range(101):
        pace.keep(0.1 * k)
    assert wall.now == pytest.approx(5.0)
    wall.now += 60.0  # the machine was busy
    pace.keep(10.1)
    pace.keep(10.2)
    assert wall.now == pytest.approx(65.05)
    pace.speed = 0.0
    pace.keep(1000.0)
    assert wall.now == pytest.approx(65.05)


def test_standing_still_ends_with_the_pause_or_the_run():
    waited = []

    def wait(seconds):
        waited.append(seconds)
        if len(waited) == 3:
            pace.paused = False
        if len(waited) == 4:
            pace.end()

    pace = Pace(clock=Wall().clock, wait=wait)
    assert not pace.stand_still()
    pace.paused = True
    assert pace.stand_still()
    assert len(waited) == 3
    pace.paused = True
    assert pace.stand_still()
    assert pace.stop
    assert not pace.stand_still()
    assert len(waited) == 4


def test_the_first_reason_to_end_stays_and_nothing_waits_any_more():
    wall = Wall()
    pace = Pace(1.0, clock=wall.clock, wait=wall.wait)
    pace.keep(0.0)
    pace.end("enough")
    pace.end()
    pace.keep(1000.0)
    assert (pace.stop, wall.now) == ("enough", 0.0)
