import numpy as np
import pytest
from painted_table import BOX, at, picture

from coral.contact.perception.masks.colour_masks import ColourMasks, paint_regions
from coral.contact.perception.model_tracker import ModelTracker
from coral.contact.perception.object_tracking import ObjectTracking, object_models

MASKS = ColourMasks(paint_regions({"box": (200 / 255, 60 / 255, 40 / 255)}))


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
