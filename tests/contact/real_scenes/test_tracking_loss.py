import pytest

from coral.contact.perception.camera import RgbdCameraCfg
from coral.contact.perception.depth_noise import DepthNoise
from coral.contact.perception.model_tracker import ModelTracker
from coral.contact.perception.tracker import PoseEstimate
from coral.contact.real_scenes.benchmark_motions import motion_of
from coral.contact.real_scenes.tracking_accuracy import AccuracyCfg
from coral.contact.real_scenes.tracking_loss import measure_loss

CFG = AccuracyCfg(camera=RgbdCameraCfg(width=240, height=180), noise=DepthNoise(), period_s=0.2, registrations=3)


@pytest.mark.parametrize("how", ["out of view", "covered"])
def test_a_loss_is_noticed_reported_and_recovered(trial, how):
    loss = measure_loss(trial, ModelTracker, CFG, how)
    assert loss.noticed_frames == 1
    assert loss.reported == 1.0
    assert loss.reason == "not seen"
    assert loss.recovered_frames == 1
    assert loss.mm < 5
    assert loss.deg < 3


class Scripted:
    """Reports a loss in these pictures, counted from 0, and never moves."""

    def __init__(self, pose, lost):
        self.pose, self.lost, self.seen = pose, lost, 0

    def register(self, frame, mask):
        return self.track(frame, mask)

    def track(self, frame, mask, guess=None):
        lost = self.seen in self.lost
        self.seen += 1
        return PoseEstimate(self.pose, 1.0, lost, 1.0, "gone" if lost else "")

    def close(self):
        pass


@pytest.mark.parametrize(
    ("lost", "noticed", "reported", "recovered"),
    [
        (range(0), 0, 0.0, 1),  # never noticed
        (range(4, 8), 1, 1.0, 1),  # at once, and as long as it was gone
        (range(6, 10), 3, 0.5, 3),  # two pictures late, both times
        (range(4, 12), 1, 1.0, 0),  # never found again
    ],
)
def test_pictures_are_counted_from_the_first_one_without_the_object(trial, lost, noticed, reported, recovered):
    here = motion_of(trial).at(0.0).objects["box"]
    cfg = AccuracyCfg(camera=RgbdCameraCfg(width=64, height=48), noise=None, period_s=0.25)
    loss = measure_loss(trial, lambda model: Scripted(here, lost), cfg, "out of view")
    assert (loss.noticed_frames, loss.reported, loss.recovered_frames) == (noticed, reported, recovered)
    assert loss.reason == ("gone" if lost else "")
    # It was put down 8 cm on, turned by 40 degrees.
    assert (loss.mm, loss.deg) == (pytest.approx(80.0), pytest.approx(40.0, abs=1e-3))
