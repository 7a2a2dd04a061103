import numpy as np
import pytest
from painted_table import BOX, at, picture

from coral.contact.perception.model_tracker import ModelTracker
from coral.contact.perception.tracker import PoseEstimate
from coral.contact.real_scenes.hand_mask import HandReading
from coral.contact.real_scenes.masks.colour_masks import ColourMasks, paint_regions
from coral.contact.real_scenes.object_tracking import ObjectTracking, object_models
from coral.contact.scene.geometry import pose_matrix

MASKS = ColourMasks(paint_regions({"box": (200 / 255, 60 / 255, 40 / 255)}, "mine.yaml"))


def test_an_object_is_found_followed_and_lost_without_masks():
    tracking = ObjectTracking({"box": BOX}, lambda name: ModelTracker(BOX), MASKS)
    for x in (0.0, 0.01):
        frame, _ = picture(at(x, 0.0))
        frame.instance[:] = 7  # what a simulation may have left there
        found = tracking.update(frame)["box"]
        assert not found.lost
        assert found.T_world_object[:3, 3] == pytest.approx([x, 0.0, 0.03], abs=0.003)
    frame, _ = picture()
    assert tracking.update(frame)["box"].lost
    tracking.close()


class Seer:
    """Sees the box where it is told to; None: lost."""

    name, wants_colours = "seer", False

    def __init__(self):
        self.sees, self.guesses = at(0.0, 0.0), []

    def track(self, frame, mask, guess=None):
        self.guesses.append(guess)
        lost = self.sees is None
        return PoseEstimate(
            np.eye(4) if lost else self.sees, 0.0 if lost else 1.0, lost, reason="covered" if lost else ""
        )


def hand(x, opening_m=0.06, wanted_m=0.03):
    """The palm looks down at a box of 6 cm at x, between the fingers."""
    return HandReading(pose_matrix(np.diag([1.0, -1.0, -1.0]), [x, 0.0, 0.03]), opening_m, wanted_m)


def test_what_the_fingers_hold_moves_with_the_hand_although_it_is_not_seen():
    seer = Seer()
    tracking = ObjectTracking({"box": BOX}, lambda name: seer, MASKS)
    frame, _ = picture(at(0.0, 0.0))
    tracking.update(frame, hand(0.0, wanted_m=0.06))
    assert not tracking.in_hand  # the fingers touch it, and do not squeeze
    tracking.update(frame, hand(0.0))
    inside = tracking.in_hand["box"]
    assert inside[:3, 3] == pytest.approx(np.zeros(3), abs=1e-6)
    seer.sees = None
    assert tracking.update(frame, hand(0.3))["box"].lost
    assert tracking.in_hand["box"] == pytest.approx(inside)
    assert seer.guesses[-1][:3, 3] == pytest.approx([0.3, 0.0, 0.03])  # where the tracker may look for it
    tracking.update(frame, hand(0.3, opening_m=0.08, wanted_m=0.08))
    assert not tracking.in_hand


def test_what_lies_beside_the_hand_is_not_held():
    seer = Seer()
    tracking = ObjectTracking({"box": BOX}, lambda name: seer, MASKS)
    frame, _ = picture(at(0.0, 0.0))
    tracking.update(frame, hand(0.15, opening_m=0.0, wanted_m=-0.01))
    assert not tracking.in_hand


def test_masks_are_told_only_what_is_tracked():
    told = []

    class Nothing:
        name, wants_colours = "nothing", False

        def segment(self, frame, poses):
            told.append(dict(poses))
            return {}

    tracking = ObjectTracking({"box": BOX}, lambda name: ModelTracker(BOX), Nothing())
    frame, _ = picture(at(0.0, 0.0))
    assert tracking.update(frame)["box"].reason == "not seen"
    tracking.update(frame)
    assert told == [{}, {}]


def test_the_objects_of_a_trial_have_their_shapes(trial):
    models = object_models(trial)
    assert set(models) == {"box", "can"}
    assert models["box"].diameter == pytest.approx(np.linalg.norm([0.12, 0.08, 0.06]))
