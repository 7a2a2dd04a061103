import numpy as np
from given_networks import given, one_hot

from coral.reef.eyes.painted_or_real import PaintedOrRealEyes
from coral.reef.eyes.perception import CameraAttitude
from coral.reef.eyes.reef_net import ReefNetEyes
from coral.reef.vehicle.camera import CameraCfg


def eyes(label, unlike=None):
    flat = np.full((1, 1, 2, 4), 2.0, np.float32)
    out = {"logits": one_hot([[label] * 4] * 2), "depth": flat, "depth_doubt": flat}
    if unlike is not None:
        out["unlike"] = np.array([unlike], np.float32)
    return ReefNetEyes(given(out, channels=4))


def test_each_picture_goes_to_the_network_of_its_kind():
    def seen(unlike):
        both = PaintedOrRealEyes(eyes(1, unlike), eyes(3))
        return both.perceive(np.zeros((2, 4, 3), np.uint8), CameraCfg(width=4, height=2), CameraAttitude())

    real, painted = seen((1.4, 2.0)), seen((2.0, 1.4))
    assert (real.labels == 1).all()
    assert (real.real, round(real.unlike, 3)) == (True, 1.4)
    assert (painted.labels == 3).all()
    assert (painted.real, painted.unlike) == (False, 0.0)
