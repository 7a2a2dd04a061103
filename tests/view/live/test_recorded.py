import numpy as np
import pytest

from coral.view.live.pace import Pace
from coral.view.live.recorded import Player, RecordedRun
from coral.view.live.state import LiveState
from coral.view.run import RunFolder


@pytest.fixture(scope="module")
def recording(finished):
    return RecordedRun(RunFolder.read(finished))


def test_any_moment_of_a_recording(recording):
    state = recording.at(17.0)
    assert (state.title, state.until_s) == ("made-up <reef>", 40.0)
    assert state.asked.since_s == 16.0
    assert state.asked.attempt == 1
    assert state.answered.verdict == "malformed"
    assert state.answered.reason == "Not valid JSON."
    assert [name for name, _ in state.pictures] == ["Camera: oysters green, obstacles dark", "Depth: near is bright"]
    assert {n.name: n.value for n in state.numbers} == {
        "coverage": "33 %",
        "clusters": "1 of 3",
        "collisions": "0",
        "advisor calls": "3 (1 again)",
        "speed": "0.25 m/s",
    }
    (body,) = state.bodies
    assert body.position[:2] == pytest.approx((2.0 + 0.18 * 17, 2.0 + 0.18 * 17 + 0.4 * np.sin(17 / 4)), abs=1e-3)
    assert all(chart.t[-1] == pytest.approx(17.0) for chart in state.charts)


def test_time_goes_both_ways(recording):
    late, early = recording.at(40.0), recording.at(1.0)
    assert late.status == "ended: time limit"
    assert early.status == "paused"
    assert early.answered is None
    assert (early.ground.cells > 0).sum() < (late.ground.cells > 0).sum()


def test_a_killed_or_empty_run_is_shown_as_far_as_it_goes(killed):
    state = RecordedRun(RunFolder.read(killed)).at(1e9)
    assert "cut off" in state.about
    assert state.bodies
    for name in ("events.jsonl", "trajectory.csv", "attempts.jsonl", "world.yaml"):
        (killed / name).write_text("")
    state = RecordedRun(RunFolder.read(killed)).at(0.0)
    assert state.bodies == ()
    assert state.asked is None


def test_the_player_plays_seeks_and_stops_at_the_end(recording):
    player = Player(recording, Pace(10.0))
    player.advance(1.0)
    assert player.t == 10.0
    player.play(False)
    player.advance(1.0)
    assert player.t == 10.0
    player.seek(35.0)
    player.play(True)
    player.advance(2.0)
    assert (player.t, player.pace.paused) == (40.0, True)
    player.play(True)
    assert (player.t, player.pace.paused) == (0.0, False)


def test_the_player_shows_each_moment_once(recording):
    class Page:
        shown: list[LiveState] = []

        def due(self, *, only_new):
            return not only_new

        def show(self, state):
            self.shown.append(state)

    def wait(_):
        now[0] += 1.0
        if now[0] > 9:
            player.pace.end()

    now = [0.0]
    player = Player(recording, Pace(10.0))
    player.run(Page(), lambda: now[0], wait)
    assert [s.t for s in Page.shown] == [0.0, 10.0, 20.0, 30.0, 40.0]
