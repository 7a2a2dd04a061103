"""Which poses can be relied on: confidence, and the reasons against."""

import dataclasses

import numpy as np
import pytest
from drawn_object import BOX, LENS, picture, tilted

from coral.contact.perception import confidence
from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.confidence import assess_pose, is_unseen, patch_around
from coral.contact.perception.image_patch import robot_mask

TRUTH = tilted()


def frame(robot=None):
    """The box before a wall, behind the robot where that is."""
    depth, box = picture(BOX, TRUTH)
    instance = box.astype(np.uint8)
    if robot is not None:
        depth, instance = np.where(robot, 0.3, depth).astype(np.float32), np.where(robot, 2, instance).astype(np.uint8)
    return RgbdFrame(depth, instance, ("box", "robot"), LENS, np.eye(4))


def assess(pose, robot=None, following=True):
    seen = frame(robot)
    return assess_pose(BOX, patch_around(seen, seen.mask("box"), BOX, [pose], 10**6), pose, following)


def moved(metres):
    pose = TRUTH.copy()
    pose[0, 3] += metres
    return pose


def hiding(share):
    """A robot before the left part of the box."""
    columns = np.nonzero(picture(BOX, TRUTH)[1])[1]
    robot = np.zeros((120, 160), bool)
    robot[:, : int(np.quantile(columns, share))] = True
    return robot


def test_the_true_pose_is_relied_on():
    found = assess(TRUTH, following=False)
    assert (found.reason, found.visible) == ("", 1.0)
    assert found.confidence > 0.98


def test_confidence_falls_with_the_error_until_the_pose_does_not_fit():
    confidences = [assess(moved(metres)).confidence for metres in (0.0, 0.01, 0.03, 0.06)]
    assert confidences == sorted(confidences, reverse=True)
    assert assess(moved(0.06)).reason == "does not fit"


def test_more_is_asked_of_a_new_pose_than_of_a_tracked_one():
    pose = next(moved(m) for m in np.arange(0.0, 0.05, 0.002) if assess(moved(m)).confidence < confidence.FOUND_ABOVE)
    assert assess(pose).confidence > confidence.LOST_BELOW
    assert assess(pose, following=True).reason == ""
    assert assess(pose, following=False).reason == "does not fit"


def test_an_object_behind_the_robot_is_covered():
    found = assess(TRUTH, hiding(0.95))
    assert found.reason == "covered"
    assert found.visible < confidence.MIN_VISIBLE
    assert assess(TRUTH, hiding(0.5)).reason == ""


def test_with_little_to_see_confidence_is_lower():
    share = 1.0 - 1.5 * confidence.MIN_VISIBLE  # visible: between min_visible and twice that
    found = assess(TRUTH, hiding(share))
    assert found.confidence == pytest.approx(found.visible / (2 * confidence.MIN_VISIBLE), rel=0.05)


def test_too_few_pixels_are_not_seen():
    seen = frame()
    mask = np.zeros((120, 160), bool)
    mask.flat[: confidence.MIN_PIXELS] = True
    assert not is_unseen(seen, mask)
    blind = dataclasses.replace(seen, depth=np.where(np.arange(160) == 0, 0.0, seen.depth).astype(np.float32))
    assert is_unseen(blind, mask)  # one of them has no depth
    with pytest.raises(ValueError, match="mask of shape"):
        is_unseen(seen, mask[:5])


def test_a_camera_that_does_not_label_the_robot_shows_none():
    robot = hiding(0.5)
    np.testing.assert_array_equal(robot_mask(frame(robot)), robot)
    unlabelled = dataclasses.replace(frame(robot), names=("box",))
    assert not robot_mask(unlabelled).any()
