"""Pixels on the sea floor."""

from dataclasses import replace

import numpy as np

from coral.reef.products.seen_points import find_points, grid_shape, lens_of, transform_of


def test_cells_are_those_of_a_plain_computation(recording):
    one = next(iter(recording.keyframes()))
    points = find_points(one, recording, 0.05, grid_shape(recording, 0.05), range_m=4.0)
    transform, (focal, cx, cy) = transform_of(one, recording), lens_of(recording)
    v, u = np.indices(one.frame.depth.shape)
    z = np.where(np.isfinite(one.frame.depth), one.frame.depth, 0.0).astype(float)
    optical = np.stack([(u - cx) / focal * z, (v - cy) / focal * z, z], axis=-1)
    world = optical @ transform[:3, :3].T + transform[:3, 3]
    column, row = (np.floor(world[..., k] / 0.05).astype(int) for k in (0, 1))
    ny, nx = grid_shape(recording, 0.05)
    away = np.linalg.norm(optical, axis=-1)
    there = (z > 0) & (away <= 4.0) & (column >= 0) & (row >= 0) & (column < nx) & (row < ny)
    assert (ny, nx) == (160, 180)
    np.testing.assert_array_equal(points.cell, np.where(there, row * nx + column, -1))


def test_pixels_too_doubtful_for_the_map_are_nowhere(recording):
    one = next(iter(recording.keyframes()))
    doubtful = replace(one, frame=replace(one.frame, doubt=np.full(one.frame.depth.shape, 0.9, np.float32)))
    assert (find_points(doubtful, recording, 0.05, (160, 180)).cell == -1).all()


def test_looks_are_counted_by_picture(products, recording):
    seen = products.looks > 0
    assert products.looks.max() <= products.keyframes
    assert seen[np.isfinite(products.cells.nearest) & (products.cells.nearest < 4.0)].all()
    height = transform_of(next(iter(recording.keyframes())), recording)[2, 3]
    assert products.cells.nearest[products.cells.cells() == 1].min() > height - 0.15
