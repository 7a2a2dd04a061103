import numpy as np
import pytest

from coral.contact.perception.camera import RgbdCameraCfg
from coral.contact.perception.depth_noise import DepthNoise
from coral.contact.real_scenes.benchmark_motions import MotionSample, motion_of
from coral.contact.real_scenes.posed_scene import PosedScene
from coral.contact.scene.rigid_transform import pose_matrix

SMALL = RgbdCameraCfg(width=160, height=120)


@pytest.fixture(scope="module")
def stage(trial):
    return PosedScene(trial, SMALL, None)


@pytest.fixture(scope="module")
def aside(trial):
    """Everything at its start, the hand out of the way."""
    start = motion_of(trial).at(0.0)
    return MotionSample(start.objects, pose_matrix(start.tool[:3, :3], np.array([-0.5, 0.4, 0.5])), 0.04)


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
    moved = pose_matrix(aside.objects["box"][:3, :3], aside.objects["box"][:3, 3] + np.array([0.1, 0.05, 0.08]))
    before = stage.take(aside, rng)
    after = stage.take(MotionSample(aside.objects | {"box": moved}, aside.tool, 0.04), rng)
    way = middle(stage, after, "box") - middle(stage, before, "box")
    np.testing.assert_allclose(way, [0.1, 0.05, 0.08], atol=0.01)
    assert np.linalg.norm(middle(stage, after, "can") - middle(stage, before, "can")) < 0.005


def test_a_hand_before_an_object_hides_it(stage, aside):
    rng = np.random.default_rng(0)
    camera = stage.camera.T_world_camera[:3, 3]
    between = 0.4 * camera + 0.6 * aside.objects["can"][:3, 3]
    covered = stage.take(MotionSample(aside.objects, pose_matrix(aside.tool[:3, :3], between), 0.04), rng)
    assert covered.mask("can").sum() < 0.5 * stage.take(aside, rng).mask("can").sum()
    assert covered.mask("robot").any()


def test_without_noise_a_picture_depends_on_nothing_but_the_poses(stage, aside):
    first, second = (stage.take(aside, np.random.default_rng(seed), time_s=seed) for seed in (1, 2))
    np.testing.assert_array_equal(first.depth, second.depth)


def test_noise_is_the_seeds(trial, aside):
    stage = PosedScene(trial, SMALL, DepthNoise())
    first, again, other = (stage.take(aside, np.random.default_rng(seed)).depth for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()
