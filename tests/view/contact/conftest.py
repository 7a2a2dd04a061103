"""A recorded run of the hand's world."""

import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.control.planning_world import PlanningCfg
from coral.contact.cost.stages import Guide, Stage, Strategy
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.episode import Episode
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.strategist import FixedStrategist
from coral.mppi.knots import KnotMppiCfg

sys.path.insert(0, str(Path(__file__).parents[2] / "contact"))

COARSE = EpisodeCfg(
    poses="ground-truth",
    planning=PlanningCfg(threads=1),
    controller=ControllerCfg(horizon=10, mppi=KnotMppiCfg(samples=10, knots=3), guided=0.5),
)


def poke():
    """Down upon the box, then stay: two stages, a contact."""
    above = Guide(lambda state: state.box_pos[0, :1])
    return Strategy(
        "poke",
        (
            Stage(
                "down",
                lambda state: {
                    "reach": 10 * np.linalg.norm(state.ee_pos - state.box_pos, axis=-1),
                    "calm": 0.01 * np.square(state.ee_vel).sum(axis=-1),
                },
                (above,),
                until=lambda now: bool(now.box_hand_contact[0, 0]),
            ),
            Stage("rest", lambda state: {"calm": np.square(state.ee_vel).sum(axis=-1)}),
        ),
    )


@pytest.fixture(scope="session")
def recorded(tmp_path_factory):
    """A run of 1.2 s in the hand's world."""
    folder = tmp_path_factory.mktemp("contact") / "run"
    task = load_task("pick-box").model_copy(update={"time_limit_s": 1.2})
    Episode(sample_trial(task, 3), "hand", FixedStrategist(poke()), COARSE, folder, variant="expert").run()
    return folder


@pytest.fixture
def copy(recorded, tmp_path):
    return shutil.copytree(recorded, tmp_path / "run")
