"""What noise does to a perfect picture."""

import dataclasses

import numpy as np
import pytest
from ball_before_wall import scene

from coral.contact.perception.depth_noise import D435, DepthNoiseCfg
from coral.contact.perception.noise_kernels import disturb

NONE = DepthNoiseCfg(
    axial_m=0.0,
    axial_growth=0.0,
    uneven_m=0.0,
    lateral_px=0.0,
    wavy_px=0.0,
    disparity_step_px=0.0,
    grazing_deg=90.0,
    edge_hole=0.0,
    hole=0.0,
)


def test_noise_has_the_spread_of_the_formula_and_is_the_seed_s():
    plain = DepthNoiseCfg(uneven_m=0.0, disparity_step_px=0.0, hole=0.0)
    camera, data = scene(noise=plain)
    first = camera.take(data, np.random.default_rng(3))
    again = camera.take(data, np.random.default_rng(3))
    np.testing.assert_array_equal(first.depth, again.depth)
    corner = first.depth[:30, :40]  # straight on enough, and away from the ball
    assert np.std(corner) == pytest.approx(0.0012 + 0.0019 * 0.6**2, rel=0.1)
    with pytest.raises(ValueError, match="random"):
        camera.take(data)


def test_the_noise_kernel_against_numpy():
    rng = np.random.default_rng(0)
    shape = height, width = 30, 40
    depth = np.where(rng.random(shape) < 0.1, np.inf, 0.8 + 0.3 * (np.arange(width) > 20) + 0.001 * rng.random(shape))
    normal = rng.normal(size=(*shape, 3)) * [0.8, 0.8, 1.0]
    normal[..., 2] = -np.abs(normal[..., 2])
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    instance = rng.integers(0, 4, shape).astype(np.uint8)
    lens = np.array([35.0, 35.0, 19.5, 14.5])
    lateral, wavy = (rng.standard_normal((2, *shape), np.float32) for _ in range(2))
    axial, uneven = (rng.standard_normal(shape, np.float32) for _ in range(2))
    chance = rng.random(shape, np.float32)
    amounts = np.array([0.4, 0.5, 0.0012, 0.0019, 0.001, 400.0, 0.14, 0.3, 0.01, 0.03])
    measured, labels = np.empty(shape), np.empty(shape, np.uint8)
    disturb(depth, normal, instance, lens, lateral, wavy, axial, uneven, chance, amounts, measured, labels)

    shift = np.rint(0.4 * lateral + 0.5 * wavy).astype(int)
    rows = (np.arange(height)[:, None] + shift[0]).clip(0, height - 1)
    columns = (np.arange(width) + shift[1]).clip(0, width - 1)
    np.testing.assert_array_equal(labels, instance[rows, columns])
    seen = np.minimum(depth, 99.0)
    jump = np.abs(seen[rows, columns] - seen) > 0.03
    z = np.where(jump, seen[rows, columns], seen)
    jump[:, 1:] |= np.abs(np.diff(seen, axis=1)) > 0.03
    jump[1:] |= np.abs(np.diff(seen, axis=0)) > 0.03
    p, q = (np.arange(width) - 19.5) / 35.0, (np.arange(height)[:, None] - 14.5) / 35.0
    facing = -(normal[..., 0] * p + normal[..., 1] * q + normal[..., 2]) / np.sqrt(1 + p**2 + q**2)
    hole = (z > 98) | (chance < np.where(jump, 0.3, 0.01)) | (facing < 0.14)
    tilt = np.minimum(np.arccos(facing.clip(-1, 1)), 1.5)
    spread = 0.0012 + 0.0019 * (z - 0.4) ** 2 + 1e-4 / np.sqrt(z) * (tilt / (np.pi / 2 - tilt)) ** 2
    z = z + spread.clip(0, 0.05) * axial + 0.001 * z**2 * uneven
    expected = np.where(hole, np.inf, 400.0 / np.rint(400.0 / z))
    np.testing.assert_allclose(measured, expected, rtol=1e-9)
    assert 0.1 < np.isinf(measured).mean() < 0.9


def test_outlines_are_jagged_and_full_of_holes():
    camera, data = scene(noise=DepthNoiseCfg())
    clean, _ = scene()
    frame, truth = camera.take(data, np.random.default_rng(0)), clean.take(data)
    wrong = frame.mask("ball") != truth.mask("ball")
    assert 0 < wrong.sum() < 0.2 * truth.mask("ball").sum()
    assert (frame.depth == 0)[55:65, 60:100].sum() > 0


def seen(cfg, width=64, depth_m=1.0):
    """A wall straight ahead, measured."""
    shape = (48, width)
    normal = np.broadcast_to([0.0, 0.0, -1.0], (*shape, 3)).copy()
    lens = np.array([500.0 * width / 640, 500.0 * width / 640, width / 2 - 0.5, 23.5])
    return cfg.apply(np.full(shape, depth_m), normal, np.ones(shape, np.uint8), lens, np.random.default_rng(0))


def test_without_any_amount_only_the_paper_s_own_spread_at_a_slant_is_left():
    measured, labels = seen(NONE)
    np.testing.assert_allclose(measured, 1.0, atol=5e-4)
    assert (labels == 1).all()


def test_a_d435_errs_as_its_disparity_does():
    measured, _ = seen(dataclasses.replace(D435, uneven_m=0.0, disparity_step_px=0.0, hole=0.0), width=640)
    assert np.std(measured) == pytest.approx(0.08 / 424 / 0.05, rel=0.1)  # z^2 dd / (f b) at 1 m


def test_depth_is_quantised_in_disparity():
    # 500 px for 640 columns, 0.05 m apart, steps of a sixteenth: 400 steps at 1 m
    measured, _ = seen(DepthNoiseCfg(uneven_m=0.0, hole=0.0))
    steps = 500.0 * 0.05 / 0.0625 / measured
    np.testing.assert_allclose(steps, np.rint(steps), atol=1e-9)
    assert len(np.unique(np.rint(steps))) > 1


def test_so_many_pixels_return_nothing():
    measured, _ = seen(dataclasses.replace(NONE, hole=0.2), width=640)
    assert np.isinf(measured).mean() == pytest.approx(0.2, abs=0.01)


def test_unevenness_is_shared_by_neighbours():
    measured, _ = seen(dataclasses.replace(NONE, uneven_m=0.01), width=640)
    off = measured - 1.0
    assert np.std(off) > 0.003
    assert np.std(np.diff(off, axis=1)) < 0.1 * np.std(off)
