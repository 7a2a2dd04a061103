from dataclasses import replace

import numpy as np
import pytest

from coral.contact.perception.camera import RgbdCameraCfg
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.real_scenes.posed_scene import PosedScene, scene_at_start
from coral.contact.scene.observation import BodyState

SMALL = TrackedCfg(camera=RgbdCameraCfg(width=160, height=120), noise=False)


@pytest.fixture(scope="module")
def stage(trial):
    return PosedScene(trial, SMALL)


@pytest.fixture(scope="module")
def aside(trial):
    return scene_at_start(trial)


def moved(state, name, by):
    """Return the state with an object moved."""
    one = state.objects[name]
    return replace(state, objects={**state.objects, name: BodyState(one.position + by, one.quaternion)})


def middle(stage, frame, name):
    """Where the pixels of an object are, in the world."""
    rows, columns = np.nonzero(frame.mask(name))
    depth = frame.depth[rows, columns]
    fx, fy, cx, cy = frame.lens
    points = np.stack([(columns - cx) / fx * depth, (rows - cy) / fy * depth, depth], axis=1)
    T = frame.T_world_camera
    return (points @ T[:3, :3].T + T[:3, 3]).mean(axis=0)


def test_objects_are_seen_where_they_are_put(stage, aside):
    rng = np.random.default_rng(0)
    before = stage.take(aside, rng)
    after = stage.take(moved(aside, "box", np.array([0.1, 0.05, 0.08])), rng)
    way = middle(stage, after, "box") - middle(stage, before, "box")
    np.testing.assert_allclose(way, [0.1, 0.05, 0.08], atol=0.01)
    assert np.linalg.norm(middle(stage, after, "can") - middle(stage, before, "can")) < 0.005


def test_a_hand_before_an_object_hides_it(stage, aside):
    rng = np.random.default_rng(0)
    camera = stage.camera.T_world_camera[:3, 3]
    between = 0.4 * camera + 0.6 * aside.objects["can"].position
    covered = stage.take(replace(aside, tool=BodyState(between, aside.tool.quaternion)), rng)
    assert covered.mask("can").sum() < 0.5 * stage.take(aside, rng).mask("can").sum()
    assert covered.mask("robot").any()


def test_without_noise_a_picture_depends_on_nothing_but_the_poses(stage, aside):
    first, second = (stage.take(replace(aside, time_s=seed), np.random.default_rng(seed)) for seed in (1, 2))
    np.testing.assert_array_equal(first.depth, second.depth)


def test_noise_is_the_seeds(trial, aside):
    stage = PosedScene(trial, replace(SMALL, noise=True))
    first, again, other = (stage.take(aside, np.random.default_rng(seed)).depth for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()
