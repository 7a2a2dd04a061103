"""Where to touch: surface regions that an advisor names, checked, and the candidate points of Eq. 3 that follow.

Regions are given in the object's own frame, so that they stay right while the object moves.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, Field, RootModel

from coral.advisor.question import Rejection
from coral.config import Positive
from coral.contact.context import Context
from coral.contact.geometry import quaternion_of, rotate, rotation_of
from coral.contact.hand import MAX_OPENING_M
from coral.contact.strategy import Guide

Array = NDArray[np.float64]
Approach = Literal["push", "press", "pinch"]
PAD_M = 0.010
"""From the tool to a finger's forward face."""
TIP_M = 0.008
"""From the tool to the fingers' tips."""


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
        """Object and region, in order."""
        return [(name, region) for name, held in self.root.items() for region in held.regions]


@dataclass(frozen=True, kw_only=True)
class RegionCfg:
    """What a region may be.

    Args:
        most: Regions of one object; the paper asks for 1 to 3, a plan of several stages may need more.
        samples: Most candidates of one region.
        off_surface_m: How far a centre may lie from the surface of the object's box.
        extent_m: Largest radius.
        standoff_m: Candidates are mirrored so far out along the normal: the way in is a way from there.
    """

    most: int = 6
    samples: int = 64
    off_surface_m: Positive = 0.008
    extent_m: Positive = 0.15
    standoff_m: Positive = 0.08


def verify_regions(answer: RegionsAnswer, facts: Mapping[str, Any], stages: Sequence[str] = (),
                   cfg: RegionCfg | None = None) -> Rejection | None:
    """Why regions cannot be used, or None: unknown object, off the surface, below the table, out of the hand's reach.

    Args:
        answer: The regions.
        facts: The scene (`scene_facts`): sizes, poses, table.
        stages: Names of the plan's stages.
        cfg: Bounds.
    """
    cfg = cfg or RegionCfg()
    for name, held in answer.root.items():
        if name not in facts["objects"]:
            return _no(name, "objects", f"{name} is no object of the scene; there are {', '.join(facts['objects'])}")
        if len(held.regions) > cfg.most:
            return _no(name, "too-many", f"{len(held.regions)} regions on {name}; name the {cfg.most} that matter most")
        for index, region in enumerate(held.regions):
            reason = _wrong(region, facts["objects"][name], facts, stages, cfg)
            if reason:
                return _no(name, reason[0], f"region {index + 1} of {name}: {reason[1]}", index)
    if not answer.each():
        return Rejection(code="none", reason="no region on any object; name at least one place to touch")
    return None


def _no(name: str, code: str, reason: str, index: int | None = None) -> Rejection:
    return Rejection(code=code, reason=reason, details={"object": name, "region": index})


def _wrong(region: Region, item: Mapping[str, Any], facts: Mapping[str, Any], stages: Sequence[str], cfg: RegionCfg
           ) -> tuple[str, str] | None:
    center, normal = np.asarray(region.center), np.asarray(region.normal)
    if not (np.isfinite(center).all() and np.isfinite(normal).all() and math.isfinite(region.extent)):
        return "not-finite", "center, normal and extent must be finite numbers"
    if abs(float(np.linalg.norm(normal)) - 1.0) > 0.05:
        return "normal", f"the normal {_text(normal)} has length {np.linalg.norm(normal):.2f}; make it 1"
    if not 0.0 <= region.extent <= cfg.extent_m or not 1 <= region.num_samples <= cfg.samples:
        return "extent", (f"extent {region.extent:g} m with {region.num_samples} samples; extent lies within 0 and "
                          f"{cfg.extent_m:g} m, num_samples within 1 and {cfg.samples}")
    if region.stage and region.stage not in stages:
        return "stage", f"the plan has no stage {region.stage!r}; its stages are {', '.join(stages) or 'none'}"
    if region.opening is not None and not 0.0 <= region.opening <= MAX_OPENING_M:
        return "opening", f"the fingers open from 0 to {MAX_OPENING_M:g} m, not {region.opening:g} m"
    half, middle = np.asarray(item["size_m"]) / 2, np.asarray(item.get("middle_m", (0.0, 0.0, 0.0)))
    outside = np.maximum(np.abs(center - middle) - half, 0)
    depth = float((half - np.abs(center - middle)).min())
    off = float(np.linalg.norm(outside)) if outside.any() else depth
    box_like = item["shapes"] == ["box"] and item["solid_share"] > 0.95
    # Inside the hull's box of a rounded or compound thing there may well be surface.
    if (outside.any() or box_like) and off > cfg.off_surface_m:
        return "off-surface", (f"the center {_text(center)} lies {off:.3f} m off the surface; in the object's frame it "
                               f"extends {_text(middle - half)} to {_text(middle + half)} m")
    facing = normal * (center - middle) / np.maximum(half, 1e-6)
    if box_like and facing.max() < 0.5:
        return "inward", f"the normal {_text(normal)} does not point out of the object at {_text(center)}"
    pose = np.asarray(item["pose"])
    here, out = pose[:3] + rotate(pose[3:], center), rotate(pose[3:], normal)
    if out[2] < -0.5 and not _overhangs(here, facts):
        return "underside", "the normal points down at the table: the hand cannot get under it"
    approach = region.approach or natural_approach(out)
    if approach == "pinch" and not _graspable(region, item):
        return "too-wide", (f"the fingers open to {MAX_OPENING_M:g} m and the object is wider there; pinch a narrower "
                            "part, or push or press")
    if here[2] < -TIP_M and not _overhangs(here, facts):
        return "below-table", f"it lies {-here[2]:.3f} m below the table's top"
    return None


def _text(vector: Array) -> str:
    return "[" + ", ".join(f"{value:.3f}" for value in vector) + "]"


def _overhangs(point: Array, facts: Mapping[str, Any]) -> bool:
    return not all(facts["table"][axis][0] <= point[k] <= facts["table"][axis][1] for k, axis in enumerate("xy"))


def natural_approach(normal: Array) -> Approach:
    """Push what faces sideways, press what faces up."""
    return "press" if normal[2] > 0.7 else "push"


def closing_axis(normal: Array, size: Array) -> int | None:
    """The object's axis along which fingers can close about a point with this normal; None when all are too wide."""
    along = int(np.argmax(np.abs(normal)))
    fits = [axis for axis in range(3) if axis != along and size[axis] <= MAX_OPENING_M - 0.004]
    return min(fits, key=lambda axis: size[axis]) if fits else None


def _graspable(region: Region, item: Mapping[str, Any]) -> bool:
    if closing_axis(np.asarray(region.normal), np.asarray(item["size_m"])) is not None:
        return True
    # A handle is narrower than the thing that it is part of; the rehearsal will tell.
    return item["shapes"] != ["box"] or item["solid_share"] < 0.95 or bool(item["points"])


def candidates(region: Region) -> Array:
    """Eq. 3: points on the region's rim, and its centre, Shape=(num_samples + 1, 3), in the object's frame."""
    normal = np.asarray(region.normal) / np.linalg.norm(region.normal)
    first, second = tangents(normal)
    phi = 2 * np.pi * np.arange(region.num_samples) / region.num_samples
    ring = region.extent * (np.cos(phi)[:, None] * first + np.sin(phi)[:, None] * second)
    return np.asarray(np.concatenate([np.zeros((1, 3)), ring]) + np.asarray(region.center))


def tangents(normal: Array) -> tuple[Array, Array]:
    """Two directions that make a right-handed frame with a unit normal, Shape=(3,) each."""
    other = np.array([0.0, 0.0, 1.0]) if abs(normal[2]) < 0.9 else np.array([0.0, 1.0, 0.0])
    first: Array = np.cross(normal, other)
    first = first / np.linalg.norm(first)
    second: Array = np.cross(normal, first)
    return first, second


def guide(name: str, region: Region, size: Array, lowest_m: float = 0.012, cfg: RegionCfg | None = None) -> Guide:
    """Tool poses for a region, wherever the object is: at the candidates, and a standoff away from them.

    Args:
        name: The object.
        region: On it.
        size: Shape=(3,), its full extents, m.
        lowest_m: The tool comes no lower over the table.
        cfg: Standoff.
    """
    cfg = cfg or RegionCfg()
    local, normal = candidates(region), np.asarray(region.normal, dtype=float)
    closing = closing_axis(normal, size) if region.closing is None else region.closing

    def how(state: Context) -> tuple[Array, Array, Approach]:
        turn = state[f"{name}_quat"][0, 0]
        out = rotate(turn, normal)
        return turn, out, region.approach or natural_approach(out)

    def points(state: Context) -> Array:
        turn, out, approach = how(state)
        surface = state[f"{name}_pos"][0, 0] + rotate(turn, local)
        if approach == "pinch":
            reach = float(size[int(np.argmax(np.abs(normal)))])
            at = surface - out * min(0.025, reach / 2)
        else:
            at = surface + out * (PAD_M if approach == "push" else TIP_M)
        away = at + out * cfg.standoff_m
        if approach == "push":
            away = np.concatenate([away, away + np.array([0.0, 0.0, cfg.standoff_m])])
        found = np.concatenate([at, away])
        on_table = (np.abs(found[:, :2] - _table_middle(state)) <= _table_half(state)).all(axis=1)
        found[:, 2] = np.where(on_table, np.maximum(found[:, 2], lowest_m), found[:, 2])
        return found

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
    """The tool orientation with these z and y axes, of the two that grasp alike the one nearer to `tool`."""
    z = palm / np.linalg.norm(palm)
    y = opening - z * float(opening @ z)
    y = y / max(float(np.linalg.norm(y)), 1e-9)
    found = [quaternion_of(np.stack([np.cross(sign * y, z), sign * y, z], axis=1)) for sign in (1.0, -1.0)]
    return np.asarray(max(found, key=lambda q: abs(float(np.dot(q, tool)))))


def _table_middle(state: Context) -> Array:
    return np.asarray((state.table_min[0, 0, :2] + state.table_max[0, 0, :2]) / 2)


def _table_half(state: Context) -> Array:
    return np.asarray((state.table_max[0, 0, :2] - state.table_min[0, 0, :2]) / 2)
