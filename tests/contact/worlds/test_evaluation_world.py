"""What every evaluation world promises: the interface that episodes, cameras and recordings use."""

import mujoco
import numpy as np
import pytest
from episodes import ObedientWorld, make_trial

from coral.contact.episode.recorder import EpisodeRecordCfg, EpisodeRecorder, columns
from coral.contact.perception.advisor_camera import AdvisorCameraCfg, make_advisor_camera
from coral.contact.perception.camera import RgbdCameraCfg
from coral.contact.perception.guessed_world import GuessedWorld
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.perception.tracked_world import TrackedWorld
from coral.contact.worlds.registry import make_world
from coral.errors import InputError
from coral.runs import RunWriter

SMALL = TrackedCfg(camera=RgbdCameraCfg(width=160, height=120))


def look(world, trial):
    camera = make_advisor_camera(world, trial, SMALL, AdvisorCameraCfg(), np.random.default_rng(0))
    return camera()


def record(world, folder):
    writer = RunWriter(folder, columns(["box"]))
    recorder = EpisodeRecorder(writer, EpisodeRecordCfg(), ["box"])
    recorder.state(0, 0.0, world)
    recorder.close(0)
    writer.close()
    return folder / "states.csv"


@pytest.fixture
def trial():
    return make_trial()


def test_a_simulated_world_shows_the_state_that_it_steps(trial):
    world = make_world("hand", trial, 0.02)
    now = world.reset()
    simulation = world.simulation
    assert isinstance(simulation.model, mujoco.MjModel)
    np.testing.assert_array_equal(simulation.data.body("box").xpos, now.objects["box"].position)
    assert simulation.model.opt.timestep < world.control_period_s


def test_wrappers_pass_the_simulation_on(trial):
    world = make_world("hand", trial, 0.02)
    for wrapper in (GuessedWorld(world, trial), TrackedWorld(world, trial, SMALL, np.random.default_rng(0))):
        assert wrapper.simulation.model is world.simulation.model
        assert wrapper.simulation.data is world.simulation.data


def test_a_simulated_world_has_pictures_and_recorded_joint_positions(trial, tmp_path):
    world = make_world("hand", trial, 0.02)
    world.reset()
    assert look(world, trial).mask("box").any()
    header, row = record(world, tmp_path / "run").read_text().splitlines()
    assert len(row.split(",")) == len(header.split(",")) == 2 + world.simulation.model.nq


def test_a_world_without_a_simulation_runs_without_pictures_and_joint_positions(trial, tmp_path):
    world = ObedientWorld(trial)
    world.reset()
    assert look(world, trial) is None
    assert not record(world, tmp_path / "run").exists()


def test_simulated_cameras_refuse_a_world_without_a_simulation(trial):
    world = ObedientWorld(trial)
    with pytest.raises(InputError, match=r"--poses.*of which no pictures can be made"):
        TrackedWorld(world, trial, SMALL, np.random.default_rng(0))
    with pytest.raises(InputError, match=r"--variant.*a world of which pictures can be made"):
        GuessedWorld(world, trial)
