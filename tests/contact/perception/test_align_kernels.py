"""Alignment and the tally of agreement, against plain NumPy and known answers."""

import numpy as np
import pytest
from drawn_object import BOARD, BOX, CAN, LENS, picture, tilted

from coral.contact.perception import align_kernels as kernels
from coral.contact.perception.agreement_kernels import RESIDUAL, count_agreement, shift_onto_mask
from coral.contact.perception.image_patch import crop_patch
from coral.contact.perception.registration import misfit
from coral.contact.scene.geometry import pose_matrix, rotation_about


def slope(model, T):
    """|normal . ray| of every pixel of a drawing, with the normals of finite differences of inverse depth."""
    depth, trial = picture(model, T, np.nan)
    inverse_depth = 1.0 / depth.astype(float)
    # On a plane n . (p, q, 1) z = d: the inverse depth is linear in p and q, with gradient n / d and offset.
    p, q = (np.arange(160) - LENS[2]) / LENS[0], (np.arange(120) - LENS[3]) / LENS[1]
    best = np.full((120, 160, 3), np.nan)
    for du in (-1, 1):
        for dv in (-1, 1):
            a = (np.roll(inverse_depth, -du, 1) - inverse_depth) * du * LENS[0]
            b = (np.roll(inverse_depth, -dv, 0) - inverse_depth) * dv * LENS[1]
            n = np.stack([a, b, inverse_depth - a * p[None, :] - b * q[:, None]], -1)
            n /= np.linalg.norm(n, axis=-1, keepdims=True)
            corner = np.roll(np.roll(inverse_depth, -du, 1), -dv, 0)
            flat = np.abs(corner - inverse_depth - a * du / LENS[0] - b * dv / LENS[1]) < 1e-5
            best = np.where((np.isnan(best[..., :1]) & flat[..., None]), n, best)
    rays = np.stack(np.broadcast_arrays(p[None, :], q[:, None], 1.0), -1)
    return np.where(trial, np.abs((best * rays).sum(-1)), 0.0)


def align(seen, model, start, steps):
    return kernels.align(start, model.pivot, model.solids, seen, steps, 0.03, 0.01, 2.0, 0.0)


def patch(model, T, robot=None, pixels=10**6):
    depth, mask = picture(model, T)
    if robot is not None:
        depth = np.where(robot, 0.3, depth).astype(np.float32)
        mask &= ~robot
    none = np.zeros_like(mask)
    return crop_patch(depth, mask, none if robot is None else robot, LENS, (0, 160, 0, 120), pixels)


@pytest.mark.parametrize("model", [BOX, BOARD, CAN], ids=["box", "board", "can"])
@pytest.mark.parametrize("k", range(4))
def test_a_pose_that_is_off_is_brought_back(model, k):
    truth = tilted()
    rng = np.random.default_rng(k)
    start = truth.copy()
    start[:3, :3] = rotation_about(np.eye(3)[k % 3], 0.12) @ start[:3, :3]
    start[:3, 3] += rng.uniform(-0.015, 0.015, 3)
    found = align(patch(model, truth), model, start, 25)
    shift, turn = model.symmetry.difference(found, truth)
    assert shift < 1e-3
    assert turn < 0.01


def test_the_spin_of_a_can_stays_where_it_was():
    truth = tilted()
    spun = truth @ pose_matrix(rotation_about(np.array([0, 0, 1.0]), 1.0), np.zeros(3))
    found = align(patch(CAN, truth), CAN, spun, 10)
    assert found[:3, 0] @ spun[:3, 0] > 0.9995


def test_what_the_robot_hides_does_not_push():
    truth = tilted()
    robot = np.zeros((120, 160), bool)
    robot[:, 84:] = True
    assert 0.2 < (picture(BOX, truth)[1] & robot).sum() / picture(BOX, truth)[1].sum() < 0.8
    found = align(patch(BOX, truth, robot), BOX, truth, 10)
    shift, turn = BOX.symmetry.difference(found, truth)
    assert shift < 5e-4
    assert turn < 0.01


def test_hollow_things_do_not_slip(mug):
    truth = tilted((2.2, 0.3, 0.2))
    start = truth.copy()
    start[:3, 3] += [0.008, -0.006, 0.01]
    found = align(patch(mug, truth), mug, start, 25)
    shift, turn = mug.symmetry.difference(found, truth)
    assert shift < 1e-3
    assert turn < 0.02


def test_the_tally_against_numpy():
    truth, guess = tilted(), tilted(at=(0.035, -0.01, 0.72))
    robot = np.zeros((120, 160), bool)
    robot[50:60] = True
    seen = patch(BOX, truth, robot)
    tally = count_agreement(guess, BOX.solids, seen, 0.012)

    depth, trial = picture(BOX, guess, 0.0)
    near = np.zeros_like(trial)
    padded = np.pad(trial, 1)
    for a in range(3):
        for b in range(3):
            near |= padded[a : a + 120, b : b + 160]
    both, gap = trial & seen.mask, np.abs(seen.depth - depth) * slope(BOX, guess).clip(0.25)
    behind = trial & ~seen.mask & (robot | (seen.depth - depth < -0.012))
    expected = [
        (both & (gap < 0.012)).sum(),
        (both & (gap >= 0.012)).sum(),
        (seen.mask & ~trial & ~near).sum(),
        (trial & ~seen.mask & ~behind & (seen.mask_distance > 1.5)).sum(),
        behind.sum(),
        trial.sum(),
    ]
    np.testing.assert_array_equal(tally[:6], expected)
    assert min(expected) > 0
    assert tally[RESIDUAL] == pytest.approx((gap / 0.012)[both & (gap < 0.012)].sum(), rel=1e-4)
    assert misfit(count_agreement(truth, BOX.solids, seen, 0.012)) < misfit(tally)


def test_a_shift_onto_the_mask_brings_the_drawing_over_the_mask():
    truth = tilted()
    far = truth.copy()
    far[:3, 3] += [0.15, 0.1, 0.2]
    found = shift_onto_mask(far, BOX.solids, patch(BOX, truth), 4)
    assert np.linalg.norm(found[:3, 3] - truth[:3, 3]) < 0.005


def test_the_solver_against_numpy():
    rng = np.random.default_rng(0)
    a = rng.normal(size=(20, 6))
    h, b = 1e6 * a.T @ a, rng.normal(size=6)
    total = np.trace(h[3:, 3:])
    damped = h + 1e-3 * total * np.diag([9e-4] * 3 + [1.0] * 3)
    x = b.copy()
    assert kernels._solve(h.copy(), x)
    np.testing.assert_allclose(x, np.linalg.solve(damped, b), rtol=1e-8)
    assert not kernels._solve(np.zeros((6, 6)), np.zeros(6))
