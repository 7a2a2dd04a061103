"""The clearance between two things: the shortest distance between their shapes, over a batch of states.

Shapes are convex pieces: boxes, cylinders, spheres; a mesh counts as its bounding box. The distance of two pieces is
the smallest of three upper bounds: from the corners of each to the other, and from the nearest of these on by
alternating projections, which converge to the distance of convex sets (Cheney and Goldstein, 1959) and are needed where
an edge passes an edge. All distances are 0 inside.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from coral.contact.control.clearance_kernels import shorten
from coral.contact.control.hand_model import FINGER_HALF_M, FINGER_OUT_M, FINGER_UP_M, PALM_HALF_M, PALM_UP_M
from coral.contact.cost.context import Context, Derived
from coral.contact.scene.geometry import from_rotvec, from_rpy_deg, multiply, rotate
from coral.contact.scene.mesh import mesh_vertices
from coral.contact.scene.observation import Array
from coral.contact.scene.shapes import Shape
from coral.contact.scene.trial import Trial, part_scale, part_size

Placement = Callable[[Context], tuple[Array, Array]]
"""Function of a batch of states: positions, Shape=(K, H, 3) m, and orientations, Shape=(K, H, 4), in the world."""
PROJECTIONS = 60
"""Maximum number of alternating projections after the best corner. Most pairs need three; of boxes in random poses 2 %
are still 1 to 7 mm too far after 12, and 1 % are 1 to 3 mm after 48 (measured)."""
RIM = 8
"""Points on each rim of a cylinder."""


@dataclass(frozen=True, eq=False)
class Piece:
    """A convex piece of a thing, and where it is in a batch of states."""

    half: Array
    """Half of its extents along its own axes, Shape=(3,) m."""
    place: Placement
    round_axes: int = 0
    """2 for a cylinder along its z axis, 3 for a sphere."""

    @cached_property
    def corners(self) -> Array:
        """Return the points whose distance to another convex piece bounds its own, Shape=(n, 3), in its own axes."""
        if self.round_axes == 3:
            return np.zeros((1, 3))
        if self.round_axes == 2:
            turns = np.arange(RIM) * 2.0 * np.pi / RIM
            rim = np.stack([np.cos(turns), np.sin(turns), np.ones(RIM)], axis=1) * self.half
            return np.concatenate([rim, rim * np.array([1.0, 1.0, -1.0])])
        return np.ascontiguousarray(np.array(np.meshgrid(*([-1.0, 1.0],) * 3)).reshape(3, -1).T * self.half)


def clearances(trial: Trial) -> dict[str, Derived]:
    """Return the clearances that a cost may read, by name; shapes and fixtures are known, poses are the state's."""
    movable, fixed, hand = object_pieces(trial), fixture_pieces(trial), hand_pieces()
    found = {f"{name}_hand_clearance": _derived(each, hand) for name, each in {**movable, **fixed}.items()}
    for name, each in movable.items():
        found |= {f"{name}_{thing}_clearance": _derived(each, other) for thing, other in fixed.items()}
    for name, other in combinations(movable, 2):
        both = _derived(movable[name], movable[other])
        found |= {f"{name}_{other}_clearance": both, f"{other}_{name}_clearance": both}
    return found


def clearance(first: Sequence[Piece], second: Sequence[Piece], state: Context) -> Array:
    """Compute the shortest distance (m) between two things, 0 where they touch. Shape=(K, H), or broadcasts to it."""
    ones, others = ([piece.place(state) for piece in thing] for thing in (first, second))
    shape = np.broadcast_shapes(*(part.shape[:2] for place in (*ones, *others) for part in place))
    best = np.full(shape, np.inf).ravel()
    these, those = (
        [_flat(piece, at, shape) for piece, at in zip(thing, places, strict=True)]
        for thing, places in ((first, ones), (second, others))
    )
    for one in these:
        for other in those:
            shorten(best, *one, *other, PROJECTIONS)
    return best.reshape(shape)


def object_pieces(trial: Trial) -> dict[str, list[Piece]]:
    """Return the pieces of each movable object, whose poses are read from the state."""
    found: dict[str, list[Piece]] = {}
    for item in trial.task.objects:
        scale = trial.objects[item.name].scale
        found[item.name] = [_piece(part, scale, item.name) for part in item.parts]
    return found


def fixture_pieces(trial: Trial) -> dict[str, list[Piece]]:
    """Return table and fixtures, each one piece that does not move."""
    table = trial.task.table
    size = np.asarray(table.size)
    found = {"table": [Piece(size / 2, _still(np.array([*table.center, -size[2] / 2]), np.zeros(3)))]}
    for fixture in trial.task.fixtures:
        turn = np.array([0.0, 0.0, np.radians(fixture.yaw_deg)])
        found[fixture.name] = [Piece(np.asarray(fixture.size) / 2, _still(np.asarray(fixture.position), turn))]
    return found


def hand_pieces() -> list[Piece]:
    """Return palm and fingers, whose pose and opening are read from the state."""

    def palm(state: Context) -> tuple[Array, Array]:
        return _along(state, np.array([0.0, 0.0, PALM_UP_M]))

    def finger(side: float) -> Placement:
        def place(state: Context) -> tuple[Array, Array]:
            opening = state.gripper_opening[..., None]
            out = side * (opening / 2 + FINGER_OUT_M) * np.array([0.0, 1.0, 0.0])
            return _along(state, out + np.array([0.0, 0.0, FINGER_UP_M]))

        return place

    half = np.array(FINGER_HALF_M)
    return [Piece(np.array(PALM_HALF_M), palm), *(Piece(half, finger(side)) for side in (1.0, -1.0))]


def _derived(first: Sequence[Piece], second: Sequence[Piece]) -> Derived:
    return Derived(lambda state: clearance(first, second, state))


def _piece(part: Shape, scale: Array, name: str) -> Piece:
    size, middle = part_size(part, scale), np.asarray(part.position) * scale
    turn = from_rpy_deg(part.rpy_deg)
    if part.shape == "mesh":
        vertices = mesh_vertices(part) * part_scale(part, scale)
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        size, middle = high - low, middle + rotate(turn, (low + high) / 2)

    def place(state: Context) -> tuple[Array, Array]:
        body = state[f"{name}_quat"]
        return state[f"{name}_pos"] + rotate(body, middle), multiply(body, turn)

    return Piece(size / 2, place, {"cylinder": 2, "sphere": 3}.get(part.shape, 0))


def _still(position: Array, rotvec: Array) -> Placement:
    at = position[None, None], from_rotvec(rotvec)[None, None]
    return lambda state: at


def _along(state: Context, local: Array) -> tuple[Array, Array]:
    """Place a part of the hand at an offset from the tool, in the tool's axes."""
    return state.ee_pos + rotate(state.ee_quat, local), state.ee_quat


def _flat(piece: Piece, at: tuple[Array, Array], shape: tuple[int, ...]) -> tuple[Array, Array, Array, int, Array]:
    """Return what the kernel takes of a piece: places in every state, Shape=(n, 3) and (n, 4), and its form."""
    # One memory layout, so that the kernel is compiled once.
    position, turn = (
        np.require(
            part if part.shape[:2] == shape else np.broadcast_to(part, (*shape, part.shape[-1])), None, ["C", "W"]
        ).reshape(-1, part.shape[-1])
        for part in at
    )
    return position, turn, piece.half, piece.round_axes, piece.corners
