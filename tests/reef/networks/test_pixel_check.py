import numpy as np

from coral.reef.eyes.ground_plane import ground_depth
from coral.reef.networks.network_notes import UNIT
from coral.reef.networks.pixel_check import CAMERA, check_pixels, depth_kind, shipped_picture
from coral.reef.world.geometry import Label


def test_the_shipped_picture_shows_oysters_on_the_floor():
    rgb, labels = shipped_picture()
    assert rgb.shape == (CAMERA.height, CAMERA.width, 3)
    assert (labels == Label.OYSTER).sum() > 500
    assert rgb[-1, :, 2].mean() > rgb[-1, :, 0].mean()  # in water red fades first


def test_a_network_that_finds_oysters_only_with_blue_first_is_told():
    nothing, labels = np.zeros((120, 160), np.uint8), shipped_picture()[1]
    told = check_pixels(lambda _, way: labels if way.bgr else nothing, UNIT)
    assert "better with BGR, 0 to 1 (IoU 1.00) than with RGB, 0 to 1 (IoU 0.00)" in told
    assert check_pixels(lambda _, way: nothing if way.bgr else labels, UNIT) == ""
    assert check_pixels(lambda _rgb, _way: nothing, UNIT) == ""


def test_a_depth_map_is_told_by_its_trend_on_the_floor():
    ground = np.minimum(ground_depth(CAMERA), 20.0)
    assert depth_kind(3.0 / ground + 1.0) == "relative"
    assert depth_kind(ground) == "metric"
    assert depth_kind(np.ones_like(ground)) == ""
