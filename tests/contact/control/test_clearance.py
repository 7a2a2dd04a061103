"""Clearances against values by hand, against MuJoCo's exact distances, and the kernel against its NumPy twin."""

import mujoco
import numpy as np
import pytest
from contact_bench import body, make_trial, plain, seen

from coral.contact.control.clearance import PROJECTIONS, Piece, clearance, clearances
from coral.contact.control.clearance_kernels import SETTLED_M
from coral.contact.control.planning_world import PlanningCfg, PlanningWorld
from coral.contact.cost.context import Context
from coral.contact.scene.geometry import conjugate, multiply, rotate
from coral.contact.scene.mujoco_scene import geom_gap
from coral.contact.scene.trial import stated_beliefs

HALVES = {0: np.array([0.03, 0.05, 0.12]), 2: np.array([0.04, 0.04, 0.1]), 3: np.array([0.045, 0.045, 0.045])}
GEOMS = {0: mujoco.mjtGeom.mjGEOM_BOX, 2: mujoco.mjtGeom.mjGEOM_CYLINDER, 3: mujoco.mjtGeom.mjGEOM_SPHERE}
EMPTY = Context({}, (1, 1))


def placed(round_axes, position, quaternion, half=None):
    position, quaternion = np.atleast_2d(position)[:, None], np.atleast_2d(quaternion)[:, None]
    return Piece(HALVES[round_axes] if half is None else half, lambda state: (position, quaternion), round_axes)


def random_poses(count, seed):
    rng = np.random.default_rng(seed)
    turns = rng.normal(size=(count, 4))
    return rng.uniform(-0.2, 0.2, (count, 3)), turns / np.linalg.norm(turns, axis=1, keepdims=True)


def nearest(piece, points):
    """The nearest points of a piece, both in its own axes."""
    if piece.round_axes == 3:
        return np.zeros_like(points)
    if piece.round_axes == 2:
        out = np.linalg.norm(points[..., :2], axis=-1, keepdims=True)
        flat = points[..., :2] * np.minimum(1.0, piece.half[0] / np.maximum(out, 1e-12))
        return np.concatenate([flat, np.clip(points[..., 2:], -piece.half[2], piece.half[2])], axis=-1)
    return np.clip(points, -piece.half, piece.half)


def by_numpy(one, other):
    """The kernel's twin."""
    (position, turn), (there, turned) = one.place(EMPTY), other.place(EMPTY)
    offset, relative = rotate(conjugate(turn), there - position), multiply(conjugate(turn), turned)

    def into(points):
        return rotate(conjugate(relative)[..., None, :], points - offset[..., None, :])

    def out(points):
        return rotate(relative[..., None, :], points) + offset[..., None, :]

    theirs = out(np.broadcast_to(other.corners, (*offset.shape[:2], *other.corners.shape)))
    ours = np.broadcast_to(one.corners, (*offset.shape[:2], *one.corners.shape))
    points = np.concatenate([theirs, out(nearest(other, into(ours)))], axis=-2)
    gaps = np.concatenate(
        [
            np.linalg.norm(theirs - nearest(one, theirs), axis=-1),
            np.linalg.norm(ours - out(nearest(other, into(ours))), axis=-1),
        ],
        axis=-1,
    )
    point = np.take_along_axis(points, gaps.argmin(axis=-1)[..., None, None], axis=-2)
    best = gaps.min(axis=-1)
    going = np.ones(best.shape, dtype=bool)
    for _ in range(PROJECTIONS):
        inside = nearest(one, point)
        point = out(nearest(other, into(inside)))
        gap = np.linalg.norm(point - inside, axis=-1)[..., 0]
        fell, best = best - gap, np.where(going, np.minimum(best, gap), best)
        going &= fell >= SETTLED_M
    radii = sum(piece.half[0] for piece in (one, other) if piece.round_axes == 3)
    return np.maximum(best - radii, 0.0)


PAIRS = [(0, 0), (0, 2), (2, 2), (0, 3), (2, 3), (3, 3)]


@pytest.mark.parametrize("forms", PAIRS)
def test_the_kernel_agrees_with_its_numpy_twin(forms):
    one, other = (placed(form, *random_poses(200, seed)) for seed, form in enumerate(forms))
    np.testing.assert_allclose(clearance([one], [other], EMPTY), by_numpy(one, other), atol=1e-12)


@pytest.mark.parametrize("forms", PAIRS)
def test_distances_are_those_of_mujoco(forms):
    spec = mujoco.MjSpec()
    for name, form in zip(("one", "other"), forms, strict=True):
        half = HALVES[form]
        size = {0: half, 2: [half[0], half[2], 0], 3: [half[0], 0, 0]}[form]
        spec.worldbody.add_body(name=name, mocap=True).add_geom(name=name, type=GEOMS[form], size=size)
    model = spec.compile()
    data = mujoco.MjData(model)
    (first, turn), (second, turned) = random_poses(150, 10), random_poses(150, 11)
    found = clearance([placed(forms[0], first, turn)], [placed(forms[1], second, turned)], EMPTY)[:, 0]
    exact = np.empty(len(found))
    for k in range(len(first)):
        data.mocap_pos[:], data.mocap_quat[:] = [first[k], second[k]], [turn[k], turned[k]]
        mujoco.mj_kinematics(model, data)
        exact[k] = max(geom_gap(model, data, 0, 1, 1.0)[0], 0.0)
    assert (found > exact - 1e-4).all()  # bounds from above
    assert np.quantile(found - exact, 0.98) < 1e-3
    assert (found - exact).max() < 5e-3


def test_an_edge_that_passes_an_edge():
    long = np.array([0.2, 0.01, 0.01])
    turned = [np.cos(np.pi / 8), np.sin(np.pi / 8), 0.0, 0.0]  # an edge below
    across = multiply([np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)], turned)
    gap = clearance([placed(0, [0, 0, 0], turned, long)], [placed(0, [0.05, 0.06, 0.1], across, long)], EMPTY)
    assert gap[0, 0] == pytest.approx(0.1 - 2 * 0.01 * np.sqrt(2), abs=1e-6)


@pytest.fixture
def trial():
    tin = {"name": "tin", "parts": [{"shape": "cylinder", "size": [0.06, 0.06, 0.1]}], "mass_kg": 0.2, "friction": 0.5}
    return make_trial(objects=[*plain()["objects"], {**tin, "x": 0, "y": 0.2}])


def planned(trial, now):
    return PlanningWorld(trial, stated_beliefs(trial), now, PlanningCfg(threads=1))


def test_names_are_those_of_the_schema(trial):
    world = planned(trial, seen(trial))
    assert set(clearances(trial)) == {name for name in world.schema if name.endswith("_clearance")}
    world.close()


def test_a_state_gives_the_distances_of_its_things(trial):
    now = seen(trial, tool=(0.0, 0.0, 0.3), opening_m=0.04, box=body((0.05, -0.1, 0.08)))
    world = planned(trial, now)
    state = world.present(now)
    low = float(trial.size("box")[2] / 2)
    assert state.box_table_clearance[0, 0] == pytest.approx(0.08 - low, abs=4e-3)  # it falls for a step
    assert state.table_hand_clearance[0, 0] == pytest.approx(0.3 - 0.008, abs=2e-3)
    assert state.box_tin_clearance[0, 0] == state.tin_box_clearance[0, 0] > 0.1
    world.close()


def test_a_hand_that_is_put_elsewhere_has_the_distance_from_there(trial):
    now = seen(trial, tool=(0.0, 0.0, 0.3))
    world = planned(trial, now)
    state = world.present(now)
    heights = np.array([0.1, 0.2, 0.3])
    places = np.stack([np.zeros(3), np.zeros(3), heights], axis=1)[:, None]
    moved = Context({**{name: state.source(name) for name in state.names()}, "ee_pos": places}, (3, 1))
    assert moved.table_hand_clearance[:, 0] == pytest.approx(heights - 0.008, abs=1e-3)
    world.close()
