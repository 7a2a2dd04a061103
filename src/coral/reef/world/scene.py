"""A reef world as arrays: solids for ray casting, ground outlines for collisions and line of sight."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from coral.reef.world.geometry import Label
from coral.reef.world.kinds import find_kind
from coral.reef.world.world import Obstacle, Oyster, ReefWorld

ELLIPSOID, BOX, CYLINDER = 0, 1, 2
"""Values of `Scene.kind`. A sphere is an ellipsoid. Cylinders are upright."""
ELLIPSE, RECTANGLE = 0, 1
"""Values of `Footprints.kind`. A circle is an ellipse with equal half-axes."""
_KINDS = {"sphere": ELLIPSOID, "ellipsoid": ELLIPSOID, "box": BOX, "cylinder": CYLINDER}


class Footprints(NamedTuple):
    """K outlines on the ground plane. World frame, metres, radians."""

    kind: NDArray[np.int8]
    """ELLIPSE or RECTANGLE. Shape=(K,), int8."""
    center: NDArray[np.float64]
    """Centres. Shape=(K, 2)."""
    half: NDArray[np.float64]
    """Half-axes of the ellipse or half edges of the rectangle, along its own axes. Shape=(K, 2)."""
    yaw: NDArray[np.float64]
    """Angle of the outline's first axis, counter-clockwise from +x. Shape=(K,)."""


class SceneSolids(NamedTuple):
    """N solids as ray casters take them, the arrays of `Scene`."""

    kind: NDArray[np.int8]
    center: NDArray[np.float64]
    half: NDArray[np.float64]
    rotation: NDArray[np.float64]
    radius: NDArray[np.float64]
    """Radius of a ball about each centre that holds the solid (m). Shape=(N,)."""


@dataclass(frozen=True, eq=False)
class Scene:
    """N solids of a world: oysters by cluster, what is like them, obstacles, what lies unseen. World frame, metres."""

    kind: NDArray[np.int8]
    """ELLIPSOID, BOX or CYLINDER. Shape=(N,), int8."""
    center: NDArray[np.float64]
    """Centres. Shape=(N, 3)."""
    half: NDArray[np.float64]
    """Half-extents along the solid's own axes (cylinder: r, r, half height). Shape=(N, 3)."""
    rotation: NDArray[np.float64]
    """Rotations, object to world. Shape=(N, 3, 3)."""
    label: NDArray[np.uint8]
    """`Label` of each solid. Shape=(N,), uint8."""
    cluster: NDArray[np.int32]
    """Index into `cluster_names` of true oysters, -1 for others. Shape=(N,), int32."""
    seabed_z: float
    """Height of the flat sea floor (m)."""
    cluster_names: tuple[str, ...]
    looks: tuple[str | None, ...] = ()
    """Look of each solid in `kinds.yaml`, None for one without; empty: none has one."""
    thing: NDArray[np.int32] | None = None
    """Index of the world's thing that each solid is a part of, -1 for none. For the judge. Shape=(N,), int32."""
    circles: NDArray[np.float64] | None = None
    """What each solid goes round: rate (rad/s; 0: it rests), x and y (m). None: all rest. Shape=(N, 3)."""

    @classmethod
    @lru_cache(maxsize=4)
    def from_world(cls, world: ReefWorld) -> Scene:
        """Make the arrays of a world, in the order of its file. All who ask for a world share them."""
        oysters = [oyster for cluster in world.clusters for oyster in cluster.oysters]
        cluster = [i for i, group in enumerate(world.clusters) for _ in group.oysters]
        alike = [part for group in world.alike for part in group.oysters]
        lying = [part for group in world.lying for part in group.oysters]
        obstacles = world.solids
        solids: list[Oyster | Obstacle] = [*oysters, *alike, *obstacles, *lying]
        rpy = [o.rpy if isinstance(o, Oyster) else (0.0, 0.0, o.yaw) for o in solids]
        names: list[str | None] = [group.name for group in (*world.clusters, *world.alike) for _ in group.oysters]
        names += [o.thing for o in obstacles] + [group.name for group in world.lying for _ in group.oysters]
        number = {thing.name: i for i, thing in enumerate(world.things)}
        rounds = {one.name: (rate, one.x, one.y) for one in world.things if (rate := find_kind(one.kind).circles)}
        return cls(
            kind=np.array([_KINDS[o.shape or "ellipsoid"] for o in solids], np.int8),
            center=np.array([(o.x, o.y, o.z) for o in solids], np.float64),
            half=np.array([o.radii if isinstance(o, Oyster) else o.size for o in solids], np.float64),
            rotation=rotations(rpy),
            label=np.repeat(
                np.array([Label.OYSTER, Label.OBSTACLE, Label.SEABED], np.uint8),
                (len(oysters) + len(alike), len(obstacles), len(lying)),
            ),
            cluster=np.array(cluster + [-1] * (len(solids) - len(oysters)), np.int32),
            seabed_z=world.seabed.z_m,
            cluster_names=tuple(group.name for group in world.clusters),
            looks=tuple(o.look for o in solids) if world.things else (),
            thing=np.array([number.get(name or "", -1) for name in names], np.int32) if world.things else None,
            circles=np.array([rounds.get(name or "", (0.0, 0.0, 0.0)) for name in names]) if rounds else None,
        )

    def at(self, t: float) -> Scene:
        """Return the scene at a time (s): animals have gone round their places, all else is where it was."""
        if self.circles is None:
            return self
        rate, middle = self.circles[:, 0], self.circles[:, 1:]
        turn = rotations((0.0, 0.0, float(angle)) for angle in rate * t)
        center = self.center.copy()
        center[:, :2] = middle + np.einsum("nij,nj->ni", turn[:, :2, :2], center[:, :2] - middle)
        center[rate == 0.0] = self.center[rate == 0.0]
        return replace(self, center=center, rotation=np.ascontiguousarray(turn @ self.rotation))

    @property
    def resting(self) -> Scene:
        """The scene without what moves. Numbers of solids change."""
        if self.circles is None:
            return self
        rests = self.circles[:, 0] == 0.0
        parts = {k: getattr(self, k)[rests] for k in ("kind", "center", "half", "rotation", "label", "cluster")}
        looks = tuple(look for look, kept in zip(self.looks, rests, strict=True) if kept)
        return replace(self, **parts, looks=looks, thing=None, circles=None)

    def __len__(self) -> int:
        return len(self.kind)

    @cached_property
    def solids(self) -> SceneSolids:
        """The solids, for ray casters."""
        return SceneSolids(self.kind, self.center, self.half, self.rotation, ball_radii(self.kind, self.half))

    def footprints(self) -> Footprints:
        """Return the outlines of the obstacles, in the order of the world's `solids`."""
        return self.outlines(np.flatnonzero(self.label == Label.OBSTACLE))

    def outlines(self, index: NDArray[np.intp]) -> Footprints:
        """Return the vertical projection of solids, by index, on the ground. Boxes and cylinders are upright."""
        turn = self.rotation[index]
        half = self.half[index, :2].copy()
        yaw = np.arctan2(turn[:, 1, 0], turn[:, 0, 0])
        # The projection of {R diag(h) s : |s| <= 1} is the ellipse with the upper left 2x2 of R diag(h^2) R^T.
        shadow = np.einsum("nij,nj,nkj->nik", turn, self.half[index] ** 2, turn)[:, :2, :2]
        squares, axes = np.linalg.eigh(shadow)
        tilted = (self.kind[index] == ELLIPSOID) & (np.abs(turn[:, 2, 2]) < 1.0)
        half[tilted] = np.sqrt(squares)[tilted]
        yaw[tilted] = np.arctan2(axes[:, 1, 0], axes[:, 0, 0])[tilted]
        kind = np.where(self.kind[index] == BOX, RECTANGLE, ELLIPSE).astype(np.int8)
        return Footprints(kind=kind, center=np.ascontiguousarray(self.center[index, :2]), half=half, yaw=yaw)


def ball_radii(kind: NDArray[np.int8], half: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the radius of a ball about each solid's centre that holds it (m). Arguments as in `Scene`. Shape=(N,)."""
    upright, widest = np.hypot(half[:, 0], half[:, 2]), half.max(axis=1, initial=0.0)
    return np.select([kind == ELLIPSOID, kind == CYLINDER], [widest, upright], np.linalg.norm(half, axis=1))


def rotations(rpy: Iterable[tuple[float, float, float]]) -> NDArray[np.float64]:
    """Compute Rz(yaw) Ry(pitch) Rx(roll) of N triples of roll, pitch, yaw (rad). Shape=(N, 3, 3)."""
    angles = np.array(list(rpy), np.float64).reshape(-1, 3)
    (cr, cp, cy), (sr, sp, sy) = np.cos(angles).T, np.sin(angles).T
    rows = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    return np.ascontiguousarray(np.moveaxis(np.array(rows), -1, 0))
