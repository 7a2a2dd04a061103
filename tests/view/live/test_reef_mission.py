import asyncio
import json
import threading

import numpy as np
import pytest

from coral.advisor import clock as clock_module
from coral.advisor.clock import SimulatedClock
from coral.advisor.rules import RuleAdvisor
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.world.world import load_world
from coral.view.live.pace import STOPPED, Pace
from coral.view.live.reef_mission import LiveMission

SHORT = MissionCfg(time_limit_s=20.0, latency="fixed:3", record=RecordCfg(pictures=False, frames=False))


class Page:
    """Takes every state, as a browser without limits would."""

    def __init__(self, on_show=lambda n: None):
        self.states, self.on_show = [], on_show

    def due(self, *, only_new=False):
        return not only_new

    def show(self, state):
        self.states.append(state)
        self.on_show(len(self.states))


def run(folder, page=None, pace=None, cfg=SHORT):
    mission = Mission(load_world("l1"), cfg, RuleAdvisor(REEF_RULES), folder)
    return mission.run([LiveMission(mission, page, pace)] if page else [])


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    folder = tmp_path_factory.mktemp("plain") / "run"
    run(folder)
    return folder


@pytest.fixture(scope="module")
def watched(tmp_path_factory):
    """A mission that was watched at every tick and paused once."""
    folder = tmp_path_factory.mktemp("watched") / "run"
    waits = []

    def wait(seconds):
        waits.append(seconds)
        pace.paused = len(waits) % 3 != 0

    pace = Pace(clock=lambda: 0.0, wait=wait)
    page = Page(lambda n: setattr(pace, "paused", True) if n == 50 else None)
    result = run(folder, page, pace)
    assert len(waits) == 3
    return folder, page, result


def test_watching_and_pausing_change_nothing(plain, watched):
    folder, _, _ = watched
    for name in ("metrics.json", "trajectory.csv", "events.jsonl", "config.yaml"):
        texts = [(path / name).read_text() for path in (plain, folder)]
        if name == "config.yaml":
            texts = [text[: text.index("provenance")] for text in texts]
        assert texts[0] == texts[1], name


def test_the_page_sees_what_the_robot_believes(watched):
    _, page, result = watched
    last = page.states[-1]
    assert last.status == "ended: time limit"
    assert last.t == pytest.approx(20.0)
    lines = {line.name: line for line in last.lines}
    assert len(lines["rollouts"].segments) > 100
    assert len(lines["plan"].segments) == SHORT.controller.n_steps
    (body,) = last.bodies
    assert np.allclose(lines["trajectory"].segments[-1, 1, :2], body.position[:2])
    assert (last.ground.cells == 3).any()
    assert {n.name: n.value for n in last.numbers}["coverage"] == f"{100 * result['coverage']:.0f} %"
    assert {name for name, line in lines.items() if line.layer == "truth"} == {"truth"}
    assert [c.title for c in last.charts][-1] == "Cost of the plan, by term"
    assert last.charts[-1].values.shape == (6, len(last.charts[-1].t))


def test_a_question_is_open_until_its_verdict(watched):
    _, page, _ = watched
    first, later = (min((s for s in page.states if s.t >= t), key=lambda s: s.t) for t in (1.5, 5.0))
    assert first.asked is not None
    assert first.asked.since_s == pytest.approx(1.3)
    assert later.answered is not None
    assert later.answered.at_s == pytest.approx(4.3)


def test_a_pause_is_shown_and_ends(watched):
    _, page, _ = watched
    statuses = [s.status for s in page.states]
    assert "paused" in statuses
    assert statuses[-2].startswith("running")


def test_the_operator_stops_the_mission(tmp_path):
    pace = Pace()
    page = Page(lambda n: pace.end() if n == 30 else None)
    result = run(tmp_path / "run", page, pace)
    assert result["end_reason"] == STOPPED
    assert result["steps"] < 60
    assert page.states[-1].status == f"ended: {STOPPED}"
    assert json.loads((tmp_path / "run" / "metrics.json").read_text())["end_reason"] == STOPPED


def test_a_pause_is_not_part_of_the_wall_time(tmp_path):
    class Pausing:
        def tick(self, mission):
            mission.stood_still(1000.0)

        def stop_requested(self):
            return "enough"

    mission = Mission(load_world("l1"), SHORT, RuleAdvisor(REEF_RULES), tmp_path / "run")
    assert mission.run([Pausing()])["wall_time_s"] < -900


@pytest.mark.parametrize(("answered_at", "due"), [(107.0, 7.0), (50.0, 5.0), (3.0, 3.0)])
def test_a_pause_is_not_part_of_a_measured_latency(monkeypatch, answered_at, due):
    """Asked at 0, the run stands still from 5 to 105 s of wall time."""

    class Wall:
        now = 0.0

        def monotonic(self):
            return self.now

    wall, gate = Wall(), threading.Event()
    monkeypatch.setattr(clock_module, "time", wall)

    async def ask():
        await asyncio.to_thread(gate.wait)
        return "here"

    def answer():
        gate.set()
        clock._requests[0].future.result(10.0)
        while np.isnan(clock._requests[0].wall_s):  # stamped by the advisor's thread
            pass

    clock = SimulatedClock("measured", np.random.default_rng(0), paced=False)
    task = clock.start(clock.reply(ask, 60.0))
    for now, happen in sorted([(105.0, lambda: clock.stood_still(100.0)), (answered_at, answer)], key=lambda p: p[0]):
        wall.now = now
        happen()
    clock.advance(due - 0.1)
    assert not task.done()
    clock.advance(due)
    assert task.result() == "here"
    clock.close()
