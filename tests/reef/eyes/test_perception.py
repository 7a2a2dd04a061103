from dataclasses import replace

import numpy as np
import pytest

from coral.reef.eyes.doubt import DoubtCfg, drop_doubtful
from coral.reef.eyes.perception import CameraAttitude, SeenPicture, is_judged, perceive_frame
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Frame, Label

CAMERA = CameraCfg(width=2, height=2)


class Eyes:
    def perceive(self, rgb, camera, attitude):
        assert attitude.height == 0.9
        labels = np.array([[Label.OYSTER, Label.WATER]] * 2, np.uint8)
        depth, doubt = (np.array([row] * 2, np.float32) for row in ([2.0, 3.0], [0.1, 0.2]))
        return SeenPicture(labels, depth, doubt)


def frame(rgb):
    truth = np.array([[7.0, 8.0]] * 2, np.float32)
    return Frame(truth, np.full((2, 2), Label.OBSTACLE, np.uint8), np.array([[4, 5]] * 2, np.int32), rgb)


def test_nothing_of_the_truth_remains():
    seen = perceive_frame(frame(np.zeros((2, 2, 3), np.uint8)), Eyes(), CAMERA, CameraAttitude(height=0.9))
    assert seen.labels.tolist() == [[Label.OYSTER, Label.WATER]] * 2
    assert seen.depth.tolist() == [[2.0, np.inf]] * 2
    assert seen.instances.tolist() == [[-1, -1]] * 2
    np.testing.assert_allclose(seen.doubt, [[0.1, 0.2]] * 2)


def test_a_frame_without_colours_is_a_mistake():
    with pytest.raises(ValueError, match="no colours"):
        perceive_frame(frame(None), Eyes(), CAMERA, CameraAttitude())


def test_a_picture_unlike_all_that_is_known_is_no_evidence_of_oysters_or_floor():
    class Strange(Eyes):
        def perceive(self, rgb, camera, attitude):
            labels = np.array([[Label.OYSTER, Label.SEABED], [Label.OBSTACLE, Label.WATER]], np.uint8)
            return replace(super().perceive(rgb, camera, attitude), labels=labels, unlike=self.unlike)

    eyes, judged = Strange(), []
    for eyes.unlike in (0.9, 1.1):
        seen = perceive_frame(frame(np.zeros((2, 2, 3), np.uint8)), eyes, CAMERA, CameraAttitude(height=0.9))
        judged.append(is_judged(seen))
    assert judged == [True, False]
    np.testing.assert_allclose(seen.doubt, [[1.0, 1.0], [0.1, 0.2]])
    kept = drop_doubtful(seen, DoubtCfg())
    assert kept.labels.tolist() == [[Label.WATER, Label.WATER], [Label.OBSTACLE, Label.WATER]]
