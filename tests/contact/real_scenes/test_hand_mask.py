"""The hand's pixels, from its pose alone."""

import dataclasses

import numpy as np
import pytest

from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.real_scenes.cameras.rgbd_camera import bare_frame
from coral.contact.real_scenes.hand_mask import HandMask, HandReading
from coral.contact.real_scenes.posed_scene import PosedScene, scene_at_start
from coral.contact.scene.geometry import matrix_to_body, pose_matrix

FROM_ABOVE = TrackedCfg(noise=False, eye_m=(-0.35, -0.75, 0.6), target_m=(0.05, 0.0, 0.05))


@pytest.fixture(scope="module")
def seen(trial):
    """A picture of the hand among the objects, and the true mask of the hand."""
    tool = pose_matrix(np.diag([1.0, -1.0, -1.0]), [0.0, 0.0, 0.2])
    state = dataclasses.replace(scene_at_start(trial), tool=matrix_to_body(tool), opening_m=0.05)
    full = PosedScene(trial, FROM_ABOVE).take(state, np.random.default_rng(0))
    return full, bare_frame(full.depth, None, full.lens, full.T_world_camera, 0.0), HandReading(tool, 0.05, 0.05)


def test_the_hand_is_labelled_and_little_else(seen):
    full, bare, hand = seen
    truth, found = full.mask("robot"), HandMask().label(bare, hand).mask("robot")
    assert truth.sum() > 500
    assert (found & truth).sum() / (found | truth).sum() > 0.9


def test_what_is_nearer_than_the_hand_is_not_the_hand(seen):
    _, bare, hand = seen
    mask = HandMask()
    before = mask.label(bare, hand).mask("robot")
    half = before.shape[1] // 2
    depth = bare.depth.copy()
    depth[:, :half] = 0.2  # something before the left half of the camera
    after = mask.label(dataclasses.replace(bare, depth=depth), hand).mask("robot")
    assert not after[:, :half].any()
    assert (after[:, half:] == before[:, half:]).all()


def test_the_fingers_are_where_the_opening_says(seen):
    _, bare, hand = seen
    mask = HandMask()
    closed, opened = (mask._closed + mask._way * opening / 2 for opening in (0.0, 0.08))
    assert np.ptp(opened) - np.ptp(closed) == pytest.approx(0.08)
    wide = HandReading(hand.T_world_tool, 0.08, 0.08)
    assert (mask.label(bare, wide).mask("robot") != mask.label(bare, hand).mask("robot")).any()
