import math

import numpy as np
import pytest
from given_networks import given, one_hot

from coral.errors import InputError
from coral.reef.eyes.ground_plane import ground_depth
from coral.reef.eyes.perception import CameraAttitude
from coral.reef.eyes.reef_net import ReefNetEyes
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Label

LABELS = [[0, 2, 1, 3], [3, 2, 3, 3]]


def outputs(depth=2.0):
    flat = np.full((1, 1, 2, 4), depth, np.float32)
    return {"logits": one_hot(LABELS), "depth": flat, "depth_doubt": flat * 0.1}


def test_classes_depth_and_doubt_come_out_and_water_has_no_depth():
    camera = CameraCfg(width=4, height=2)
    file = given(outputs(), channels=4)
    seen = ReefNetEyes(file).perceive(np.zeros((2, 4, 3), np.uint8), camera, CameraAttitude())
    assert seen.labels.tolist() == LABELS
    assert np.isinf(seen.depth).tolist() == [[True, False, False, False], [False] * 4]
    assert (seen.doubt < 0.01).all()
    assert file.session.fed.shape == (1, 4, 2, 4)


def test_surfaces_beyond_the_cameras_range_are_not_seen():
    camera = CameraCfg(width=4, height=2, range_m=1.5)
    seen = ReefNetEyes(given(outputs(), channels=4)).perceive(np.zeros((2, 4, 3), np.uint8), camera, CameraAttitude())
    assert np.isinf(seen.depth).all()


def test_pictures_of_another_size_are_scaled_and_so_is_the_result():
    camera = CameraCfg(width=8, height=4)
    seen = ReefNetEyes(given(outputs(), channels=4)).perceive(np.zeros((4, 8, 3), np.uint8), camera, CameraAttitude())
    assert seen.labels.tolist() == np.repeat(np.repeat(LABELS, 2, 0), 2, 1).tolist()
    assert seen.depth.shape == seen.doubt.shape == (4, 8)


def test_another_layout_names_the_output():
    wrong = outputs()
    wrong["depth"] = np.zeros((1, 2, 2, 4), np.float32)
    with pytest.raises(InputError, match=r"net\.onnx: outputs\.depth: found \(1, 2, 2, 4\), expected"):
        ReefNetEyes(given(wrong, channels=4))


def test_an_obstacle_counts_before_it_is_the_likeliest():
    out = outputs()
    out["logits"][0, :, 0, 2] = np.log([0.02, 0.03, 0.45, 0.5])
    seen = ReefNetEyes(given(out, channels=4)).perceive(
        np.zeros((2, 4, 3), np.uint8), CameraCfg(width=4, height=2), CameraAttitude()
    )
    assert seen.labels[0, 2] == Label.OBSTACLE


def test_a_picture_of_another_shape_keeps_its_proportions():
    # 4 x 4 in a network of 4 x 2: scaled to 2 x 2, with a column of the network's picture on each side.
    camera = CameraCfg(width=4, height=4, hfov_deg=90.0)
    file = given(outputs(), channels=4)
    rgb = np.zeros((4, 4, 3), np.uint8)
    rgb[:, 2:] = 255
    seen = ReefNetEyes(file).perceive(rgb, camera, CameraAttitude())
    middle = [row[1:3] for row in LABELS]
    assert seen.labels.tolist() == np.repeat(np.repeat(middle, 2, 0), 2, 1).tolist()
    fed = file.session.fed[0]
    assert fed[0].tolist() == [[-1.0, -1.0, 1.0, 1.0]] * 2
    # Twice as many columns at the same focal length: twice the tangent of half the angle.
    wide = CameraCfg(width=4, height=2, hfov_deg=2 * math.degrees(math.atan(2.0)))
    np.testing.assert_allclose(fed[3], np.clip(1.0 / ground_depth(wide), 0.0, 4.0), rtol=1e-6)


@pytest.mark.parametrize(
    ("from_real", "from_painted", "unlike"),
    [(0.7, 1.4, 0.7), (1.4, 2.0, 1.4), (0.8, 0.5, 1.6)],
    ids=["like real ones", "like nothing", "nearer to what is painted"],
)
def test_a_picture_is_judged_if_it_is_like_real_ones(from_real, from_painted, unlike):
    file = given({**outputs(), "unlike": np.array([[from_real, from_painted]], np.float32)}, channels=4)

    def seen(**how):
        return ReefNetEyes(file, **how).perceive(
            np.zeros((2, 4, 3), np.uint8), CameraCfg(width=4, height=2), CameraAttitude()
        )

    assert seen().unlike == pytest.approx(unlike)
    assert seen(painted=True).unlike == 0.0
