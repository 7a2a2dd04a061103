"""The orthomosaic."""

from dataclasses import replace

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.products.mosaic import CLASS_COLOURS, MosaicCfg, colours_of, make_mosaic, split_bands
from coral.reef.products.mosaic_kernels import paint
from coral.reef.recordings.transforms import body_transform, camera_in_body
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Pose


def test_oysters_lie_in_the_mosaic_where_they_lie_in_the_map(products):
    mosaic = products.mosaic
    assert mosaic.colour
    assert mosaic.rgba.shape == (400, 450, 4)
    seen = mosaic.rgba[..., 3] == 255
    red = seen & (mosaic.rgba[..., 0].astype(int) - mosaic.rgba[..., 1] > 60)
    iy, ix = np.nonzero(red)
    on_map = products.cells.target[(iy * 0.02 / 0.05).astype(int), (ix * 0.02 / 0.05).astype(int)]
    assert len(iy) > 1000
    assert on_map.mean() > 0.75
    assert not mosaic.rgba[~seen].any()


def test_without_colour_pictures_it_is_of_class_colours(recording):
    def gray():
        return (replace(one, frame=replace(one.frame, rgb=None)) for one in recording.keyframes())

    mosaic = make_mosaic(replace(recording, keyframes=gray), MosaicCfg(pixel_m=0.05))
    assert not mosaic.colour
    frame = next(gray()).frame
    near = (frame.labels == 3) & (frame.depth < 1.2)
    np.testing.assert_array_equal(colours_of(frame)[near], np.tile(CLASS_COLOURS[3], (near.sum(), 1)))


CAMERA = CameraCfg(width=80, height=60, pitch_down_deg=90.0)
FOCAL, _, CX, CY = CAMERA.intrinsics


def painted(looks, hidden_by=None):
    """Paint looks straight down from (2, 2): height, shade and detail of each. Return shade and detail."""
    best, weight = np.full((40, 40), np.inf, np.float32), np.zeros((40, 40), np.float32)
    shade, fine = np.zeros((40, 40, 3), np.float32), np.zeros((40, 40, 3), np.float32)
    for height, coarse, detail in looks:
        transform = body_transform(Pose(2.0, 2.0, 0.0), height, 0.0, 0.0) @ camera_in_body(CAMERA)
        flat = [np.full((60, 80, 3), value, np.float32) for value in (coarse, detail)]
        depth = np.full((60, 80), hidden_by or height, np.float32)
        paint(*flat, depth, transform, (FOCAL, CX, CY), 0.0, 4.0, 0.02, 0.1, best, weight, shade, fine)
    return shade / np.maximum(weight, 1e-12)[:, :, None], fine


def test_detail_is_that_of_the_nearest_picture_and_shade_the_mean():
    shade, fine = painted([(1.0, 100, 20), (2.0, 40, 5), (0.8, 160, 12)])
    assert fine[20, 20, 0] == 12  # 0.8 m away beats 1 m and 2 m
    # From 0.8 m up the picture reaches 1.04 m to the front (60 rows of 80 columns, 120 degrees), from 2 m 2.6 m.
    assert fine[20, 38, 0] == 5
    assert shade[20, 38, 0] == pytest.approx(40)
    weights = np.array([1.0, 2.0, 0.8]) ** -4.0
    assert shade[20, 20, 0] == pytest.approx(weights @ [100, 40, 160] / weights.sum(), rel=0.01)


def test_nothing_is_painted_through_what_stands_before_the_floor():
    shade, fine = painted([(1.0, 100, 20)], hidden_by=0.4)
    assert not shade.any()
    assert not fine.any()


def test_bands_add_up_to_the_picture_and_differences_of_light_fade():
    rng = np.random.default_rng(0)
    rgb = rng.integers(0, 255, (60, 80, 3)).astype(np.uint8)
    coarse, detail = split_bands(rgb, 0.05)
    np.testing.assert_allclose(coarse + detail, rgb, atol=1e-3)
    assert coarse.std() < 0.3 * rgb.std()
    assert not split_bands(rgb, 0.0)[0].any()


def test_a_water_of_another_name_is_refused_and_a_known_one_changes_colours(recording):
    with pytest.raises(InputError, match=r"--cfg\.mosaic\.water: found 'jerlov-1X'"):
        make_mosaic(recording, MosaicCfg(water="jerlov-1X"))
    as_it_is, taken_back = (make_mosaic(recording, MosaicCfg(pixel_m=0.1, water=w)).rgba for w in ("", "1C"))
    far = (as_it_is[..., 3] > 0) & (taken_back[..., 0] > as_it_is[..., 0].astype(int) + 5)
    assert far.mean() > 0.05
