from dataclasses import replace

import numpy as np
import pytest
from episodes import make_trial

from coral.contact.perception.camera import RgbdCameraCfg
from coral.contact.perception.depth_noise import D435, DepthNoiseCfg
from coral.contact.perception.tracked_cfg import EYE, EYES, TARGET, TrackedCfg, make_camera, viewpoint
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.worlds.hand_world import HandWorld
from coral.errors import InputError

SMALL = TrackedCfg(camera=RgbdCameraCfg(width=64, height=48))
SERVED = replace(SMALL, by="foundationpose:http://127.0.0.1:9")


def test_poses_that_take_longer_than_a_picture_are_refused():
    with pytest.raises(InputError, match=r"latency_s.*at most period_s \(0\.04 s\)"):
        TrackedCfg(latency_s=0.1)
    assert TrackedCfg(latency_s=0.1, period_s=0.1).latency_s == 0.1


def test_a_tracker_that_there_is_not_is_refused_at_once():
    with pytest.raises(InputError, match="by: found 'models'"):
        TrackedCfg(by="models")


def test_a_task_is_seen_from_where_its_objects_are_seen_best():
    board = sample_trial(load_task("push-pick-board"), 0)
    assert viewpoint(make_trial(), SMALL) == (EYE, TARGET)
    assert viewpoint(board, SMALL) == EYES["push-pick-board"]
    assert viewpoint(board, replace(SMALL, eye_m=(0.0, 1.0, 1.0))) == ((0.0, 1.0, 1.0), EYES["push-pick-board"][1])


def test_a_camera_that_looks_straight_down_is_refused():
    with pytest.raises(InputError, match=r"target_m.*not straight below the camera"):
        viewpoint(make_trial(), replace(SMALL, eye_m=(0.1, 0.0, 1.0), target_m=(0.1, 0.0, 0.0)))


@pytest.mark.parametrize(("cfg", "coloured"), [(SMALL, False), (SERVED, True)])
def test_only_a_tracker_that_wants_colours_gets_them(cfg, coloured):
    trial = make_trial()
    world = HandWorld(trial)
    world.reset()
    frame = make_camera(world.model, trial, cfg).take(world.simulation.data, np.random.default_rng(0))
    assert (frame.rgb is not None) == coloured
    assert frame.mask("box").any()


def test_a_sensor_brings_its_noise():
    assert replace(SMALL, sensor="d435").sensor_noise() is D435
    assert SMALL.sensor_noise() == DepthNoiseCfg()
    assert replace(SMALL, noise=False, sensor="d435").sensor_noise() is None


def test_without_noise_a_picture_needs_no_seed():
    trial = make_trial()
    world = HandWorld(trial)
    world.reset()
    camera = make_camera(world.model, trial, replace(SMALL, noise=False))
    first, second = (camera.take(world.simulation.data, np.random.default_rng(seed)) for seed in (1, 2))
    np.testing.assert_array_equal(first.depth, second.depth)
