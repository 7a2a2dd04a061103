"""Contact regions: surface regions that an advisor names, their candidate points (Eq. 3, A.10), and guides to them.

Regions are given in the object's own frame, so they remain valid while the object moves.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
from pydantic import BaseModel, Field, RootModel

from coral.contact.control.hand_model import MAX_OPENING_M
from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.cost.context import Context
from coral.contact.cost.stages import Guide
from coral.contact.scene.geometry import quaternion_of, rotate, rotation_of
from coral.contact.scene.observation import Array

Approach = Literal["push", "press", "pinch"]
ReachBox = tuple[tuple[float, float, float], tuple[float, float, float]]
"""Lowest and highest corner of the box in the world, m, that bounds the tool."""
PAD_M = 0.010
"""Distance from the tool to a finger's forward face."""
TIP_M = 0.008
"""Distance from the tool to the fingertips."""
LOWEST_M = 0.012
"""Lowest height of the tool over the table."""
MOST = 6
"""Maximum number of regions per object; the paper asks for 1 to 3, a plan of several stages may need more."""
SAMPLES = 64
"""Maximum number of candidates of one region."""
OFF_SURFACE_M = 0.008
"""Maximum distance of a centre from the object's surface."""
EXTENT_M = 0.15
"""Largest radius."""
FACING = 0.5
"""Smallest cosine between the region's normal and the surface normal at a candidate."""
BURIED_M = 0.003
"""A candidate, or the tool at it, is blocked if this deep inside another thing; tracked poses err by as much."""
STANDOFF_M = 0.08
"""Guides approach a candidate from this distance along the normal."""
LIMITS = f"At most {MOST} regions for each object, {SAMPLES} points and a radius of {EXTENT_M:g} m for each."
"""The bounds of a region in a sentence."""
GOLDEN_RAD = math.pi * (3 - math.sqrt(5))


class Region(BaseModel):
    """A disc on an object's surface.

    Args:
        center: In the object's frame, m.
        normal: Out of the object, in its frame.
        extent: Radius, m.
        num_samples: Candidate points on it.
        approach: How the hand touches it: a finger's face against it, the tips onto it, or the fingers around it.
        opening: Distance between the fingers there, m; by default what the approach needs.
        stage: For which stage of the plan; "" for every one.
        closing: The object's axis (0 x, 1 y, 2 z) along which the fingers close in a pinch; by default the narrowest.
    """

    center: tuple[float, float, float]
    normal: tuple[float, float, float]
    extent: float = 0.01
    num_samples: int = 8
    approach: Approach | None = None
    opening: float | None = None
    stage: str = ""
    closing: Literal[0, 1, 2] | None = None


class ObjectRegions(BaseModel):
    """Regions of one object."""

    regions: list[Region] = Field(default_factory=list)


class RegionsAnswer(RootModel[dict[str, ObjectRegions]]):
    """The paper's A.10: regions by the objects' names."""

    def each(self) -> list[tuple[str, Region]]:
        """Yield object and region, in order."""
        return [(name, region) for name, held in self.root.items() for region in held.regions]

    def lines(self) -> list[str]:
        """Return each region in words, for a prompt."""
        return [
            f"{name}{f', stage {region.stage}' if region.stage else ''}: {region.approach or 'touch'} "
            f"{_numbers(region.center)}, normal {_numbers(region.normal)}, radius {region.extent:g}"
            for name, region in self.each()
        ]


def _numbers(vector: Sequence[float]) -> str:
    return f"[{', '.join(f'{value:g}' for value in vector)}]"


def reach_box(controller: ControllerCfg) -> ReachBox:
    """Return the box in which a controller lets the tool move."""
    return controller.workspace_low_m, controller.workspace_high_m


REACH = reach_box(ControllerCfg())


def natural_approach(normal: Array) -> Approach:
    """Choose the approach to a surface: push vertical faces, press on horizontal ones."""
    return "press" if normal[2] > 0.7 else "push"


def closing_axis(normal: Array, size: Array) -> int | None:
    """Return the object axis along which the fingers can close at a point with this normal; None if too wide."""
    along = int(np.argmax(np.abs(normal)))
    fits = [axis for axis in range(3) if axis != along and size[axis] <= MAX_OPENING_M - 0.004]
    return min(fits, key=lambda axis: size[axis]) if fits else None


def candidates(region: Region) -> Array:
    """Return points of a region's disc, Shape=(num_samples + 1, 3), object frame: centre, rim (Eq. 3), inside (A.10).

    A.10 draws them at random from the disc. Here few candidates lie evenly on the rim, as in Eq. 3; of many, most fill
    the inside evenly (sunflower: Vogel 1979, "A better way to construct the sunflower head").
    """
    normal = np.asarray(region.normal) / np.linalg.norm(region.normal)
    first, second = tangents(normal)
    rim = min(region.num_samples, round(2 * math.sqrt(region.num_samples)))
    inner = region.num_samples - rim
    phi = np.concatenate([2 * np.pi * np.arange(rim) / rim, GOLDEN_RAD * np.arange(inner)])
    rho = np.concatenate([np.ones(rim), np.sqrt((np.arange(inner) + 0.5) / (inner + rim / 2))])
    ring = region.extent * rho[:, None] * (np.cos(phi)[:, None] * first + np.sin(phi)[:, None] * second)
    return np.asarray(np.concatenate([np.zeros((1, 3)), ring]) + np.asarray(region.center))


def tangents(normal: Array) -> tuple[Array, Array]:
    """Complete a unit normal to a right-handed frame: return two directions, Shape=(3,) each."""
    other = np.array([0.0, 0.0, 1.0]) if abs(normal[2]) < 0.9 else np.array([0.0, 1.0, 0.0])
    first: Array = np.cross(normal, other)
    first = first / np.linalg.norm(first)
    second: Array = np.cross(normal, first)
    return first, second


def tool_at(surface: Array, normal: Array, size: Array, out: Array, approach: Approach) -> Array:
    """Compute the tool positions, Shape=(n, 3) m in the world, that touch points of a surface, of the same shape.

    The region's normal is in the object's frame, `out` the same in the world; `size`, Shape=(3,), is the object's (m).
    """
    if approach == "pinch":
        return np.asarray(surface - out * min(0.025, float(size[int(np.argmax(np.abs(normal)))]) / 2))
    return np.asarray(surface + out * (PAD_M if approach == "push" else TIP_M))


def guide(name: str, region: Region, size: Array, local: Array) -> Guide:
    """Make tool poses for a region, wherever the object is: at the candidates, and at a standoff from them.

    `size`, Shape=(3,), is the full extents of the object (m), `local`, Shape=(n, 3) m, the touchable candidates in its
    frame.
    """
    normal = np.asarray(region.normal, dtype=float)
    closing = closing_axis(normal, size) if region.closing is None else region.closing

    def how(state: Context) -> tuple[Array, Array, Approach]:
        turn = state[f"{name}_quat"][0, 0]
        out = rotate(turn, normal)
        return turn, out, region.approach or natural_approach(out)

    def points(state: Context) -> Array:
        turn, out, approach = how(state)
        surface = state[f"{name}_pos"][0, 0] + rotate(turn, local)
        at = tool_at(surface, normal, size, out, approach)
        away = at + out * STANDOFF_M
        if approach == "push":
            away = np.concatenate([away, away + np.array([0.0, 0.0, STANDOFF_M])])
        positions = np.concatenate([at, away])
        low, high = state.table_min[0, 0, :2], state.table_max[0, 0, :2]
        on_table = (np.abs(positions[:, :2] - (low + high) / 2) <= (high - low) / 2).all(axis=1)
        positions[:, 2] = np.where(on_table, np.maximum(positions[:, 2], LOWEST_M), positions[:, 2])
        return positions

    def quaternion(state: Context) -> Array:
        turn, out, approach = how(state)
        tool = state.ee_quat[0, 0]
        if approach == "pinch" and closing is not None:
            opening, palm = rotation_of(turn)[:, closing], -out
        else:
            palm = -out if approach == "pinch" else np.array([0.0, 0.0, -1.0])
            across = np.cross(out, palm)
            opening = across if np.linalg.norm(across) > 0.3 else rotation_of(tool)[:, 1]
        return tool_quaternion(palm, opening, tool)

    opening = region.opening
    if opening is None:
        opening = {"pinch": MAX_OPENING_M, "push": 0.0, "press": 0.0}.get(region.approach or "")
    return Guide(points, quaternion, opening)


def tool_quaternion(palm: Array, opening: Array, tool: Array) -> Array:
    """Compute the tool orientation with these z and y axes: of the two equivalent grasps, the one closer to `tool`."""
    z = palm / np.linalg.norm(palm)
    y = opening - z * float(opening @ z)
    y = y / max(float(np.linalg.norm(y)), 1e-9)
    quaternions = [quaternion_of(np.stack([np.cross(sign * y, z), sign * y, z], axis=1)) for sign in (1.0, -1.0)]
    return np.asarray(max(quaternions, key=lambda q: abs(float(np.dot(q, tool)))))
