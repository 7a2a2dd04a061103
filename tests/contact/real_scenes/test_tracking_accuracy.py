import numpy as np
import pytest

from coral.contact.perception.camera import RgbdCameraCfg
from coral.contact.perception.depth_noise import DepthNoise
from coral.contact.perception.model_tracker import ModelTracker
from coral.contact.perception.tracker import PoseEstimate
from coral.contact.real_scenes.benchmark_motions import motion_of
from coral.contact.real_scenes.tracking_accuracy import AccuracyCfg, measure_accuracy

CFG = AccuracyCfg(camera=RgbdCameraCfg(width=240, height=180), noise=DepthNoise(), period_s=0.2, registrations=3)


def test_every_object_is_followed_within_5_mm_and_3_degrees(trial):
    for row in measure_accuracy(trial, ModelTracker, CFG):
        assert row.mm < 5
        assert row.deg < 3
        assert row.lost == 0
        assert row.registered == row.registrations


class Still:
    """Believes that an object stays where it was expected; after some pictures it calls it lost."""

    def __init__(self, expected, patience):
        self.expected, self.patience, self.seen, self.closed = expected, patience, 0, False

    def register(self, frame, mask):
        return self.track(frame, mask)

    def track(self, frame, mask, guess=None):
        self.seen += 1
        return PoseEstimate(self.expected, 1.0, self.seen > self.patience, 1.0, "")

    def close(self):
        self.closed = True


def test_a_tracker_that_follows_nothing_is_found_out(trial):
    start, made = motion_of(trial).at(0.0).objects, []

    def make(model):
        made.append(Still(start["box" if model.symmetry.axis is None else "can"], patience=10))
        return made[-1]

    cfg = AccuracyCfg(camera=RgbdCameraCfg(width=64, height=48), noise=None, period_s=0.5, registrations=3)
    rows = {row.object: row for row in measure_accuracy(trial, make, cfg)}
    frames = rows["box"].frames
    assert frames == round(motion_of(trial).duration_s / 0.5) + 1
    assert rows["box"].mm > 50
    assert rows["box"].registered < rows["box"].registrations == 3
    # The can stands still: nothing is wrong with it.
    assert (rows["can"].mm, rows["can"].registered) == (pytest.approx(0.0, abs=1e-6), 3)
    assert {row.lost for row in rows.values()} == {frames - 10}
    assert all(one.closed for one in made)
    assert np.isfinite([rows["box"].update_ms, rows["box"].registration_s]).all()
