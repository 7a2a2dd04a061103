"""Alignment and the tally of agreement, against plain NumPy and known answers."""

import numpy as np
import pytest

from coral.contact.perception import align_kernels as kernels
from coral.contact.perception.agreement_kernels import RESIDUAL
from coral.contact.perception.camera import RgbdCameraCfg
from coral.contact.perception.image_patch import OCCLUDED_RIM, ROBOT, crop_patch
from coral.contact.perception.object_model import from_mesh, from_primitives
from coral.contact.perception.pose_fit import align_pose, count_agreement, shift_onto_mask
from coral.contact.perception.ray_solids import SolidPart
from coral.contact.perception.raycast_kernels import render
from coral.contact.perception.registration import RegistrationCfg, misfit, orientations
from coral.contact.scene.geometry import rotation_about, rotation_from_vector, spread_rotations
from coral.contact.scene.rigid_transform import inverse_transform, pose_matrix

LENS = RgbdCameraCfg(width=160, height=120).lens
BOX = from_primitives("box", [SolidPart("box", (0.06, 0.04, 0.03))])
BOARD = from_primitives(
    "board", [SolidPart("box", (0.15, 0.1, 0.006)), SolidPart("box", (0.05, 0.045, 0.006), (0.2, 0, 0))]
)
CAN = from_primitives("can", [SolidPart("cylinder", (0.033, 0.06))])


def picture(model, T, background=1.5):
    """Depth and mask of a model alone before a wall, and the drawing's own depth."""
    depth, solid, face = np.empty((120, 160)), np.empty((120, 160), np.int64), np.empty((120, 160), np.int64)
    back = inverse_transform(T)
    eye, turn = back[:3, 3].copy(), np.ascontiguousarray(back[:3, :3])
    render(turn, eye, LENS, 0.02, 20.0, model.solids, depth, solid, face)
    return np.where(solid >= 0, depth, background).astype(np.float32), solid >= 0


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


def patch(model, T, robot=None, pixels=10**6):
    depth, mask = picture(model, T)
    if robot is not None:
        depth = np.where(robot, 0.3, depth).astype(np.float32)
        mask &= ~robot
    none = np.zeros_like(mask)
    return crop_patch(depth, mask, none if robot is None else robot, LENS, (0, 160, 0, 120), pixels)


def tilted(turn=(0.7, 0.4, 0.2), at=(0.02, -0.01, 0.7)):
    return pose_matrix(rotation_from_vector(np.array(turn)), np.array(at))


@pytest.mark.parametrize("model", [BOX, BOARD, CAN], ids=["box", "board", "can"])
@pytest.mark.parametrize("k", range(4))
def test_a_pose_that_is_off_is_brought_back(model, k):
    truth = tilted()
    rng = np.random.default_rng(k)
    start = truth.copy()
    start[:3, :3] = rotation_about(np.eye(3)[k % 3], 0.12) @ start[:3, :3]
    start[:3, 3] += rng.uniform(-0.015, 0.015, 3)
    found = align_pose(patch(model, truth), model, start, 25, 0.03, 0.01, 2.0)
    shift, turn = model.symmetry.difference(found, truth)
    assert shift < 1e-3
    assert turn < 0.01


def test_the_spin_of_a_can_stays_where_it_was():
    truth = tilted()
    spun = truth @ pose_matrix(rotation_about(np.array([0, 0, 1.0]), 1.0), np.zeros(3))
    found = align_pose(patch(CAN, truth), CAN, spun, 10, 0.03, 0.01, 2.0)
    assert found[:3, 0] @ spun[:3, 0] > 0.9995


def test_what_the_robot_hides_does_not_push():
    truth = tilted()
    robot = np.zeros((120, 160), bool)
    robot[:, 84:] = True
    assert 0.2 < (picture(BOX, truth)[1] & robot).sum() / picture(BOX, truth)[1].sum() < 0.8
    found = align_pose(patch(BOX, truth, robot), BOX, truth, 10, 0.03, 0.01, 2.0)
    shift, turn = BOX.symmetry.difference(found, truth)
    assert shift < 5e-4
    assert turn < 0.01


def test_hollow_things_do_not_slip(mug_obj):
    mug = from_mesh("mug", mug_obj)
    truth = tilted((2.2, 0.3, 0.2))
    start = truth.copy()
    start[:3, 3] += [0.008, -0.006, 0.01]
    found = align_pose(patch(mug, truth), mug, start, 25, 0.03, 0.01, 2.0)
    shift, turn = mug.symmetry.difference(found, truth)
    assert shift < 1e-3
    assert turn < 0.02


def test_the_tally_against_numpy():
    truth, guess = tilted(), tilted(at=(0.035, -0.01, 0.72))
    robot = np.zeros((120, 160), bool)
    robot[50:60] = True
    seen = patch(BOX, truth, robot)
    tally = count_agreement(seen, BOX, guess, 0.012)

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
    assert misfit(count_agreement(seen, BOX, truth, 0.012)) < misfit(tally)


def test_the_field_is_the_distance_to_the_mask():
    mask = np.zeros((20, 30), bool)
    mask[5:12, 8:20] = True
    robot = np.zeros_like(mask)
    robot[5:12, 20:24] = True
    v = crop_patch(np.ones((20, 30), np.float32), mask, robot, LENS, (0, 30, 0, 20), 10**6)
    assert v.mask_distance[8, 5] == pytest.approx(3.0, abs=0.1)
    assert v.mask_distance[8, 8] == 0.0
    assert v.mask_distance[8, 11] == pytest.approx(-3.0, abs=0.1)
    assert (v.occlusion[5:12, 20:24] == ROBOT).all()
    assert v.occlusion[8, 19] == OCCLUDED_RIM
    assert v.occlusion[8, 8] == 0


def test_a_coarse_cut_out_has_its_own_lens():
    mask = np.zeros((120, 160), bool)
    mask[40:80, 40:120] = True
    v = crop_patch(np.ones((120, 160), np.float32), mask, ~mask, LENS, (30, 130, 30, 90), 1500)
    assert v.mask.size <= 1500
    step = LENS[0] / v.lens[0]
    assert v.lens[2] * step + 30 == pytest.approx(LENS[2])


def test_place_brings_the_drawing_over_the_mask():
    truth = tilted()
    far = truth.copy()
    far[:3, 3] += [0.15, 0.1, 0.2]
    found = shift_onto_mask(patch(BOX, truth), BOX, far, 4)
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


def test_orientations_cover_what_the_symmetry_leaves():
    for model, limit in ((CAN, 40), (BOX, 140), (BOARD, 260)):
        turns = orientations(model, RegistrationCfg())
        assert 8 <= len(turns) <= limit
        group = model.symmetry.members(36)[:, :3, :3]
        farthest = max(
            min(np.arccos(np.clip((np.einsum("gij,ij->g", t @ group, r) - 1) / 2, -1, 1)).min() for t in turns)
            for r in spread_rotations(60)
        )
        assert np.degrees(farthest) < 40
