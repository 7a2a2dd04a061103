"""A recorded contact task."""

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

COARSE = EpisodeCfg(
    poses="ground-truth",
    controller=ControllerCfg(horizon=8, mppi=KnotMppiCfg(samples=8)),
    planning=PlanningCfg(threads=1),
)


@pytest.fixture(scope="session")
def episode_at():
    """Makes a short episode that records into a folder."""

    def make(folder, limit_s=0.6):
        task = load_task("pick-box").model_copy(update={"time_limit_s": limit_s})
        strategist = FixedStrategist(expert(task, "expert-fsm"))
        return Episode(sample_trial(task, 0), "hand", strategist, COARSE, folder, variant="expert-fsm")

    return make


@pytest.fixture(scope="session")
def recorded_task(tmp_path_factory, episode_at):
    folder = tmp_path_factory.mktemp("task") / "run"
    episode_at(folder).run()
    return folder
