"""Runs that are watched: what was recorded is what would have been without."""

from types import SimpleNamespace

import numpy as np
import pytest

from coral.advisor.rules import RuleAdvisor
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.world.world import load_world
from coral.view.live.controls import Pace
from coral.view.live.viewer import Now, Viewer
from coral.view.live.watching import WatchedRun, WatchedSurvey, reef_sketch, task_sketch, watching_run

SHORT = MissionCfg(time_limit_s=12.0, latency="fixed:3", record=RecordCfg(pictures=False, frames=False))


class Page:
    """A viewer with a browser that always looks."""

    watched = True

    def __init__(self):
        self.now = Now()


def survey(folder, observers=lambda page: (), page=None):
    mission = Mission(load_world("l1"), SHORT, RuleAdvisor(REEF_RULES), folder)
    return mission, mission.run(observers(page))


def test_a_watched_mission_is_the_same_as_an_unwatched_one(tmp_path):
    page, names, waits = Page(), set(), []

    def sketch(mission):
        strokes = reef_sketch(mission)
        names.update(stroke.name for stroke in strokes)
        return strokes

    def wait(seconds):
        waits.append(seconds)
        pace.paused = False

    pace = Pace(clock=lambda: 0.0, wait=wait)
    pace.paused = True
    survey(tmp_path / "plain")
    _, result = survey(tmp_path / "watched", lambda page: [WatchedRun(page, pace, sketch)], page)
    for name in ("events.jsonl", "trajectory.csv", "metrics.json"):
        assert (tmp_path / "plain" / name).read_bytes() == (tmp_path / "watched" / name).read_bytes()
    assert waits  # it stood still once
    assert {"plan", "path to the goal"} <= names
    assert page.now.status == "ended: time limit"
    assert result["end_reason"] == "time limit"


def test_the_operator_stops_a_run(tmp_path):
    page, pace = Page(), Pace()
    pace.end("enough")
    _, result = survey(tmp_path / "run", lambda page: [WatchedRun(page, pace, reef_sketch)], page)
    assert result["end_reason"] == "enough"
    assert page.now.status == "ended: enough"


def test_the_plan_of_a_task_is_drawn_with_its_objects(episode_at, tmp_path):
    page, seen = Page(), []
    watcher = WatchedRun(page, Pace(), lambda episode: seen.append(task_sketch(episode)) or seen[-1])
    episode_at(tmp_path / "run", 0.3).run([watcher])
    names = [stroke.name for stroke in seen[-1]]
    assert names[-1] == "plan"
    assert "objects in the plan" in names
    assert np.asarray(seen[-1][-1].points).shape[1] == 3


def test_nothing_is_drawn_while_nobody_looks():
    page = Page()
    page.watched = False
    run = SimpleNamespace(end_reason="", t=0.0)
    WatchedRun(page, Pace(), lambda run: pytest.fail("drawn")).tick(run)
    assert page.now.status == "running"


def test_a_survey_tells_its_state_its_battery_and_what_it_asks():
    page = Page()
    watcher = WatchedSurvey(page, None, lambda run: (), real_time=True)
    watcher.waiting(("camera: good", "battery: full"))
    assert (page.now.status, page.now.note) == ("preflight", "camera: good\nbattery: full")
    states = SimpleNamespace(state=SimpleNamespace(value="holding"), reason="too blind")
    report = SimpleNamespace(battery_fraction=0.5)
    watcher.tick(SimpleNamespace(end_reason="", states=states, report=report, notice="align?"))
    assert (page.now.status, page.now.note) == ("holding - too blind", "align?")
    assert page.now.numbers == (("battery", "50%"),)


def test_the_run_waits_for_a_viewer_and_the_page_stays(tmp_path, capsys, monkeypatch):
    waited = []
    monkeypatch.setattr(Viewer, "wait_for_viewer", lambda self, what: waited.append(what))
    monkeypatch.setattr(Viewer, "stay", lambda self: waited.append("stay"))
    mission = SimpleNamespace(writer=SimpleNamespace(folder=tmp_path), instructing=None)
    with watching_run(mission, "reef", port=0, speed=1.0, wait=True) as viewers:
        assert waited == ["mission"]
        assert len(viewers) == 1
    assert waited == ["mission", "stay"]
    with watching_run(mission, "reef", port=0, speed=1.0, wait=False):
        assert "watch the mission at http://127.0.0.1:" in capsys.readouterr().err
    assert waited == ["mission", "stay"]


def test_the_stop_button_of_a_task_stops_an_arm_at_once(tmp_path):
    stopped = []
    world = SimpleNamespace(stop_now=lambda: stopped.append("now"), in_real_time=True)
    episode = SimpleNamespace(writer=SimpleNamespace(folder=tmp_path), world=world, weights=None)
    with watching_run(episode, "contact", port=0, speed=1.0, wait=False) as (watched,):
        assert watched.viewer.controls.press("stop", None)
        assert watched.pace.stop
    assert stopped == ["now"]
