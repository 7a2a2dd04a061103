"""How well each part was seen."""

import numpy as np

from coral.reef.products.seen_points import transform_of


def test_distance_and_looks_agree_with_the_map_and_the_pictures(products, recording):
    quality = products.quality
    seen = quality.looks > 0
    assert np.isinf(quality.nearest_m[~seen]).all()
    assert quality.looks.max() <= products.keyframes
    # The map's own note of the nearest look is without obstacles.
    both = np.isfinite(products.cells.nearest) & (quality.nearest_m < 4.0)
    assert (np.abs(quality.nearest_m[both] - products.cells.nearest[both]) > 0.01).mean() < 0.002


def test_no_cell_is_seen_from_nearer_than_the_camera_is_high(products, recording):
    height = transform_of(next(iter(recording.keyframes())), recording)[2, 3]
    ground = products.cells.cells() == 1
    assert products.quality.nearest_m[ground].min() > height - 0.15
    focal = recording.camera.intrinsics[0]
    assert products.quality.pixel_m(focal)[ground].min() > (height - 0.15) / focal
