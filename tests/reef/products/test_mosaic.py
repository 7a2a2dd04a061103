"""The orthomosaic."""

from dataclasses import replace

import numpy as np

from coral.reef.products.mosaic import CLASS_COLOURS, MosaicCfg, colours_of, make_mosaic


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


def test_a_point_takes_its_colour_from_the_nearest_picture():
    from coral.reef.camera import CameraCfg
    from coral.reef.geometry import Pose
    from coral.reef.products.mosaic_kernels import paint
    from coral.reef.recordings.transforms import body_transform, camera_in_body

    camera = CameraCfg(width=80, height=60, pitch_down_deg=90.0)
    focal, _, cx, cy = camera.intrinsics
    best, made = np.full((40, 40), np.inf, np.float32), np.zeros((40, 40, 3), np.uint8)
    for height, colour in ((1.0, 200), (2.0, 50), (0.8, 120)):
        transform = body_transform(Pose(2.0, 2.0, 0.0), height, 0.0, 0.0) @ camera_in_body(camera)
        depth = np.full((60, 80), height, np.float32)
        rgb = np.full((60, 80, 3), colour, np.uint8)
        paint(rgb, depth, transform, (focal, cx, cy), 0.0, 4.0, 0.02, 0.1, best, made)
    assert made[20, 20, 0] == 120  # 0.8 m away beats 1 m and 2 m
    # From 0.8 m up the picture reaches 1.04 m to the front (60 rows of 80 columns, 120 degrees), from 2 m 2.6 m.
    assert made[20, 38, 0] == 50
    hidden = np.full((40, 40, 3), 0, np.uint8)
    paint(rgb, np.full((60, 80), 0.4, np.float32), transform, (focal, cx, cy), 0.0, 4.0, 0.02, 0.1,
          np.full((40, 40), np.inf, np.float32), hidden)  # fmt: skip
    assert not hidden.any()  # something stands before the floor
