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
