"""A recorded contact run on the live page."""

import shutil

import numpy as np
import pytest

from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.control.planning_world import PlanningCfg
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.episode import Episode
from coral.contact.experts import expert
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.strategist import FixedStrategist
from coral.mppi.knots import KnotMppiCfg
from coral.view.live.recorded_task import RecordedTask
from coral.view.run import RunFolder

COARSE = EpisodeCfg(
    poses="ground-truth",
    controller=ControllerCfg(horizon=8, mppi=KnotMppiCfg(samples=8)),
    planning=PlanningCfg(threads=1),
)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    folder = tmp_path_factory.mktemp("task") / "run"
    task = load_task("pick-box").model_copy(update={"time_limit_s": 0.6})
    strategist = FixedStrategist(expert(task, "expert-fsm"))
    Episode(sample_trial(task, 0), "hand", strategist, COARSE, folder, variant="expert-fsm").run()
    return folder


@pytest.fixture
def copy(recorded, tmp_path):
    return shutil.copytree(recorded, tmp_path / "run")


def test_a_recorded_task_shows_any_moment(recorded):
    recording = RecordedTask(RunFolder.read(recorded))
    first, last = recording.at(0.0), recording.at(recording.duration_s)
    assert first.status == "paused"
    assert last.status.startswith("ended")
    places = [
        np.array(next(body.position for body in state.bodies if body.name.startswith("hand")))
        for state in (first, last)
    ]
    assert np.linalg.norm(places[1] - places[0]) > 0.005
    plans = [event for event in recording.run.events if event["event"] == "plan"]
    assert plans
    assert sum(len(chart.t) for chart in last.charts[1:]) == len(plans)
    assert not any(line.name == "plan" and len(line.segments) for line in last.lines)  # plans are not recorded


def test_a_run_that_was_killed_at_once_is_shown_as_far_as_it_went(copy):
    header = (copy / "trajectory.csv").read_text().splitlines()[0]
    (copy / "trajectory.csv").write_text(header + "\n")
    (copy / "events.jsonl").write_text("")
    (copy / "metrics.json").unlink()
    state = RecordedTask(RunFolder.read(copy)).at(0.0)
    assert (state.bodies, state.lines) == ((), ())
    assert "cut off" in state.about
