"""Validation of the regions that an advisor names; each rejection gives a reason that helps to improve them."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from coral.advisor.question import Rejection
from coral.contact.control.hand_model import MAX_OPENING_M
from coral.contact.plan.contact_regions import (
    EXTENT_M,
    FACING,
    MOST,
    OFF_SURFACE_M,
    REACH,
    SAMPLES,
    TIP_M,
    ReachBox,
    Region,
    RegionsAnswer,
    closing_axis,
    natural_approach,
)
from coral.contact.plan.convex_pieces import Solid
from coral.contact.plan.touchable_points import AWAY, MISSED, Candidates, Scenery, candidates_of, off_surface
from coral.contact.scene.facts import ObjectFacts, SceneFacts, on_table
from coral.contact.scene.geometry import rotate
from coral.contact.scene.observation import Array


def verify_regions(
    answer: RegionsAnswer, facts: SceneFacts, stages: Sequence[str], scenery: Scenery, reach: ReachBox = REACH
) -> Rejection | None:
    """Return why regions cannot be used, or None: unknown object, off the surface, or no point that can be touched."""
    for name, held in answer.root.items():
        if name not in facts["objects"]:
            reason = f"{name} is no object of the scene; there are {', '.join(facts['objects'])}"
            return _reject(name, "objects", reason)
        if len(held.regions) > MOST:
            return _reject(name, "too-many", f"{len(held.regions)} regions on {name}; name the {MOST} that matter most")
        for index, region in enumerate(held.regions):
            wrong = _defect(region, facts["objects"][name], scenery.objects[name], facts, stages)
            if wrong:
                return _reject(name, wrong[0], f"region {index + 1} of {name}: {wrong[1]}", index)
    if not answer.each():
        return Rejection(code="none", reason="no region on any object; name at least one place to touch")
    candidates = candidates_of(answer, facts, stages, scenery, reach)
    places = [(name, index) for name, held in answer.root.items() for index in range(len(held.regions))]
    for (name, index), left in zip(places, candidates, strict=True):
        if not len(left.points):
            code, reason = _no_candidate_left(left, facts["objects"][name], reach)
            return _reject(name, code, f"region {index + 1} of {name}: {reason}", index)
    return None


def _reject(name: str, code: str, reason: str, index: int | None = None) -> Rejection:
    return Rejection(code=code, reason=reason, details={"object": name, "region": index})


def _defect(
    region: Region, item: ObjectFacts, solids: Sequence[Solid], facts: SceneFacts, stages: Sequence[str]
) -> tuple[str, str] | None:
    """Return what is wrong with a region before its candidates are examined."""
    center, normal = np.asarray(region.center), np.asarray(region.normal)
    if not (np.isfinite(center).all() and np.isfinite(normal).all() and math.isfinite(region.extent)):
        return "not-finite", "center, normal and extent must be finite numbers"
    if abs(float(np.linalg.norm(normal)) - 1.0) > 0.05:
        return "normal", f"the normal {_text(normal)} has length {np.linalg.norm(normal):.2f}; make it 1"
    if not 0.0 <= region.extent <= EXTENT_M or not 1 <= region.num_samples <= SAMPLES:
        return "extent", (
            f"extent {region.extent:g} m with {region.num_samples} samples; extent lies within 0 and "
            f"{EXTENT_M:g} m, num_samples within 1 and {SAMPLES}"
        )
    if region.stage and region.stage not in stages:
        return "stage", f"the plan has no stage {region.stage!r}; its stages are {', '.join(stages) or 'none'}"
    if region.opening is not None and not 0.0 <= region.opening <= MAX_OPENING_M:
        return "opening", f"the fingers open from 0 to {MAX_OPENING_M:g} m, not {region.opening:g} m"
    off = off_surface(center, solids)
    if off > OFF_SURFACE_M:
        return "off-surface", (
            f"the center {_text(center)} lies {off:.3f} m off the surface; in the object's frame it "
            f"extends {_extent(item)}"
        )
    if _points_inward(center, normal, solids):
        return "inward", (
            f"the normal {_text(normal)} does not point out of the object at {_text(center)}; turn it round, or move "
            "the center to another face"
        )
    pose = np.asarray(item["pose"])
    here, out = pose[:3] + rotate(pose[3:], center), rotate(pose[3:], normal)
    if out[2] < -0.5 and on_table(facts["table"], here):
        return "underside", "the normal points down at the table: the hand cannot get under it"
    approach = region.approach or natural_approach(out)
    if approach == "pinch" and not _graspable(region, item):
        return "too-wide", (
            f"the fingers open to {MAX_OPENING_M:g} m and the object is wider there; pinch a narrower "
            "part, or push or press"
        )
    if here[2] < -TIP_M and on_table(facts["table"], here):
        return "below-table", f"it lies {-here[2]:.3f} m below the table's top; touch the object higher"
    return None


def _points_inward(center: Array, normal: Array, solids: Sequence[Solid]) -> bool:
    """Check whether a line along the normal enters the object: it leaves it far ahead, or sideways."""
    unit = normal / np.linalg.norm(normal)
    at = center - 0.5 * OFF_SURFACE_M * unit
    inside = [solid.leave(at[None], unit) for solid in solids if solid.depth(center[None])[0] > -OFF_SURFACE_M]
    return bool(inside) and not any(
        not np.isfinite(rise[0]) or (rise[0] <= 1.5 * OFF_SURFACE_M and facing[0] @ unit >= FACING)
        for rise, facing in inside
    )


def _no_candidate_left(left: Candidates, item: ObjectFacts, reach: ReachBox) -> tuple[str, str]:
    """Return why no candidate of a region can be touched."""
    count = sum(left.lost.values())
    reasons = ", ".join(f"{number} {reason}" for reason, number in left.lost.items())
    worst = max(left.lost, key=lambda reason: left.lost[reason])
    code, mend = "buried", "touch it on a side that is free"
    if worst == MISSED:
        code, mend = "missed", f"in the object's frame it extends {_extent(item)}"
    elif worst == AWAY:
        low, high = map(np.asarray, reach)
        code, mend = "out-of-reach", f"in the world the hand gets from {_text(low)} to {_text(high)} m"
    return code, f"none of its {count} candidate points can be touched: {reasons}; {mend}"


def _extent(item: ObjectFacts) -> str:
    half, middle = np.asarray(item["size_m"]) / 2, np.asarray(item.get("middle_m", (0.0, 0.0, 0.0)))
    return f"{_text(middle - half)} to {_text(middle + half)} m"


def _text(vector: Array) -> str:
    return "[" + ", ".join(f"{value:.3f}" for value in vector) + "]"


def _graspable(region: Region, item: ObjectFacts) -> bool:
    if closing_axis(np.asarray(region.normal), np.asarray(item["size_m"])) is not None:
        return True
    # A handle is narrower than its object; the imagined run decides.
    return item["shapes"] != ["box"] or item["solid_share"] < 0.95 or bool(item["points"])
