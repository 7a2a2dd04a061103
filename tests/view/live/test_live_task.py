"""A contact task on the live page: what it shows, and that watching changes nothing."""

import json

import pytest

from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.control.planning_world import PlanningCfg
from coral.contact.control.term_weights import TermWeights
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.episode import Episode
from coral.contact.episode.recorder import EpisodeRecordCfg
from coral.contact.experts import expert
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.strategist import FixedStrategist
from coral.mppi.knots import KnotMppiCfg
from coral.view.live.live_task import LiveTask
from coral.view.live.pace import Pace
from coral.view.live.task_controls import TaskControls

TASK = load_task("pick-box").model_copy(update={"time_limit_s": 0.6})
CFG = EpisodeCfg(
    poses="ground-truth",
    controller=ControllerCfg(horizon=8, mppi=KnotMppiCfg(samples=8)),
    planning=PlanningCfg(threads=1),
    record=EpisodeRecordCfg(report=False),
)


class Page:
    """Takes every state; `act` is called with each."""

    def __init__(self, act=lambda n: None):
        self.states, self.act = [], act

    def due(self, *, only_new=False):
        return not only_new

    def show(self, state):
        self.states.append(state)
        self.act(len(self.states))


def run(folder, page=None, pace=None, weights=None):
    task = TASK
    episode = Episode(
        sample_trial(task, 0), "hand", FixedStrategist(expert(task, "expert-fsm")), CFG, folder, variant="expert-fsm"
    )
    episode.weights = weights or episode.weights
    viewers = [LiveTask(episode, page, pace or Pace(), TaskControls(pace or Pace(), episode.weights))] if page else []
    return episode.run(viewers)


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    folder = tmp_path_factory.mktemp("plain") / "run"
    run(folder)
    return folder


def test_watching_changes_nothing(tmp_path, plain):
    page = Page()
    result = run(tmp_path / "run", page, weights=TermWeights())
    assert (tmp_path / "run" / "trajectory.csv").read_bytes() == (plain / "trajectory.csv").read_bytes()
    assert result["interventions"] == 0
    last = page.states[-1]
    assert last.status == "ended: timeout"
    assert "not held" in last.log[0]
    drawn = {line.name: len(line.segments) for line in last.lines}
    assert drawn["plan"] == 7
    assert drawn["tried"] >= 7 * 7
    assert [chart.title for chart in last.charts] == ["Force on the hand (N)", "Cost by term, stage reach"]


def test_a_weight_acts_at_once_and_is_recorded_as_the_operators(tmp_path, plain):
    weights = TermWeights()
    page = Page(lambda n: weights.set("reach", "reach", 0.0) if n == 4 else None)
    result = run(tmp_path / "run", page, weights=weights)
    assert result["interventions"] == 1
    events = [json.loads(line) for line in (tmp_path / "run" / "events.jsonl").read_text().splitlines()]
    (told,) = [event for event in events if event["event"] == "weight"]
    assert (told["stage"], told["term"], told["factor"], told["by"]) == ("reach", "reach", 0.0, "operator")
    after = [event["terms"]["reach"] for event in events if event["event"] == "plan" and event["t"] >= told["t"]]
    assert after
    assert not any(after)
    assert (tmp_path / "run" / "trajectory.csv").read_bytes() != (plain / "trajectory.csv").read_bytes()


def test_the_page_can_stop_a_task(tmp_path):
    pace = Pace()
    page = Page(lambda n: pace.end() if n == 4 else None)
    assert run(tmp_path / "run", page, pace)["end_reason"] == "stopped by the operator"
    assert page.states[-1].status == "ended: stopped by the operator"
