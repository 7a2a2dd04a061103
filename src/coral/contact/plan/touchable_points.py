"""Which candidates of a region can be touched: on the object's true surface, clear of other things, within reach."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from coral.contact.plan.contact_regions import (
    BURIED_M,
    FACING,
    LOWEST_M,
    OFF_SURFACE_M,
    REACH,
    TIP_M,
    ReachBox,
    Region,
    RegionsAnswer,
    candidates,
    natural_approach,
    tool_at,
)
from coral.contact.plan.convex_pieces import Solid, box, pieces
from coral.contact.scene.facts import SceneFacts
from coral.contact.scene.geometry import from_rotvec, rotate, rotation_of
from coral.contact.scene.observation import Array
from coral.contact.scene.trial import Trial

MISSED, TABLE, AWAY = "off the face", "below the table's top", "out of the hand's reach"
FLUSH_M = 1e-4
"""A candidate this close to the surface is not moved: advisors round to this."""
SEAM_M = 5e-4
"""A point of one part is on the surface if it is this far from being inside another part."""


@dataclass(frozen=True)
class Scenery:
    """The convex pieces of the objects, each in its own frame."""

    objects: Mapping[str, tuple[Solid, ...]]

    @classmethod
    def of(cls, trial: Trial) -> Scenery:
        """Return the true shapes of a trial."""
        return cls({name: pieces(trial, name) for name in trial.objects})


@dataclass(frozen=True)
class Candidates:
    """The candidates of a region that can be touched."""

    points: Array
    """Shape=(n, 3) m, in the object's frame, on its surface."""
    lost: Mapping[str, int]
    """Number of dropped candidates by reason."""


def project(points: Array, normal: Array, solids: Sequence[Solid], center: Array) -> Array:
    """Project points of a disc along its normal to the surface, Shape=(n, 3) m; nan where they miss the face.

    A point moves no farther than a surface with a slope of 45 degrees requires; where the surface turns away from the
    normal, of length 1, it counts as another face. The solids are convex, in the points' frame.
    """
    projected = np.full(points.shape, np.nan)
    least = OFF_SURFACE_M + np.linalg.norm(points - center, axis=1) + 1e-9
    for index, solid in enumerate(solids):
        rise, facing = solid.leave(points, normal)
        there = points + rise[:, None] * normal
        surface = np.isfinite(rise) & (facing @ normal >= FACING)
        for other in (*solids[:index], *solids[index + 1 :]):
            surface &= ~(other.depth(there + SEAM_M * normal) > 0)
        nearer = surface & (np.abs(rise) < least)
        least[nearer] = np.abs(rise)[nearer]
        projected[nearer] = np.where(np.abs(rise[nearer, None]) < FLUSH_M, points[nearer], there[nearer])
    return projected


def off_surface(center: Array, solids: Sequence[Solid]) -> float:
    """Compute the distance (m) of a point from an object's surface: inside it, along its axes."""
    depth = max(float(solid.depth(center[None])[0]) for solid in solids)
    if depth < -SEAM_M:
        return -depth
    distances = [np.inf]
    for way in np.concatenate([np.eye(3), -np.eye(3)]):
        for index, solid in enumerate(solids):
            rise, _ = solid.leave(center[None], way)
            past = center[None] + (rise[:, None] + SEAM_M) * way
            others = (*solids[:index], *solids[index + 1 :])
            if rise[0] >= -SEAM_M and not any(other.depth(past)[0] > 0 for other in others):
                distances.append(abs(float(rise[0])))
    return min(distances)


def candidates_of(
    answer: RegionsAnswer, facts: SceneFacts, stages: Sequence[str], scenery: Scenery, reach: ReachBox = REACH
) -> list[Candidates]:
    """Find the touchable candidates of every region, in the regions' order.

    An object is examined in its present pose for the stage that touches it first; before later stages it may have been
    moved, and so may other objects that are touched earlier.
    """
    order = {stage: index for index, stage in enumerate(stages)}
    begins: dict[str, int] = {}
    for name, region in answer.each():
        begins[name] = min(order.get(region.stage, 0), begins.get(name, len(order)))
    candidates = []
    for name, region in answer.each():
        when = order.get(region.stage, 0)
        standing = [other for other in facts["objects"] if other != name and begins.get(other, when) >= when]
        candidates.append(touchable(name, region, facts, scenery, reach, standing if when == begins[name] else None))
    return candidates


def touchable(
    name: str, region: Region, facts: SceneFacts, scenery: Scenery, reach: ReachBox, standing: Sequence[str] | None
) -> Candidates:
    """Find the touchable candidates of one region.

    `standing` are other objects in their present poses; None if this object may have moved: only its surface counts.
    """
    normal = np.asarray(region.normal, dtype=float) / np.linalg.norm(region.normal)
    points = project(candidates(region), normal, scenery.objects[name], np.asarray(region.center))
    on_face = np.isfinite(points).all(axis=1)
    lost: Counter[str] = Counter()
    if not on_face.all():
        lost[MISSED] = int((~on_face).sum())
    points = points[on_face]
    if standing is None or not len(points):
        return Candidates(points, dict(lost))
    reasons = _hindrances(name, region, points, facts, scenery, reach, standing)
    lost.update(reason for reason in reasons if reason)
    return Candidates(points[[not reason for reason in reasons]], dict(lost))


def _hindrances(
    name: str,
    region: Region,
    points: Array,
    facts: SceneFacts,
    scenery: Scenery,
    reach: ReachBox,
    standing: Sequence[str],
) -> list[str]:
    """Return why each point cannot be touched in the object's present pose; "" if it can."""
    pose, normal = np.asarray(facts["objects"][name]["pose"], dtype=float), np.asarray(region.normal, dtype=float)
    surface, out = pose[:3] + rotate(pose[3:], points), rotate(pose[3:], normal)
    approach = region.approach or natural_approach(out)
    tool = tool_at(surface, normal, np.asarray(facts["objects"][name]["size_m"]), out, approach)
    ends = np.array([facts["table"]["x"], facts["table"]["y"]])
    over_table = ((tool[:, :2] >= ends[:, 0]) & (tool[:, :2] <= ends[:, 1])).all(axis=1)
    reasons = np.full(len(points), "", dtype=object)
    reasons[over_table & (surface[:, 2] < -TIP_M)] = TABLE
    tool[:, 2] = np.where(over_table, np.maximum(tool[:, 2], LOWEST_M), tool[:, 2])
    for thing, solids in _other_solids(facts, scenery, [name, *standing]):
        for solid in solids:
            buried = (solid.depth(surface) > BURIED_M) & (thing != name)
            # In a pinch the tool is inside the object, so it cannot show whether something stands beside the fingers.
            blocked = (solid.depth(tool) > BURIED_M) & (approach != "pinch")
            reasons[(reasons == "") & buried] = f"inside {thing}"
            reasons[(reasons == "") & blocked] = f"with no room for a finger before {thing}"
    low, high = map(np.asarray, reach)
    outside = (tool < low).any(axis=1) | (tool > high).any(axis=1)
    reasons[(reasons == "") & outside] = AWAY
    return [str(reason) for reason in reasons]


def _other_solids(facts: SceneFacts, scenery: Scenery, standing: Sequence[str]) -> list[tuple[str, list[Solid]]]:
    """Return everything else in the scene, in the world frame."""
    things = []
    for name in standing:
        pose = np.asarray(facts["objects"][name]["pose"], dtype=float)
        turn = rotation_of(pose[3:])
        solids = [
            Solid(one.planes, one.radius, one.round_axes, pose[:3] + turn @ one.position, turn @ one.rotation)
            for one in scenery.objects[name]
        ]
        things.append((name, solids))
    for name, item in facts["fixtures"].items():
        turn = rotation_of(from_rotvec([0, 0, np.radians(item["yaw_deg"])]))
        things.append((name, [box(np.asarray(item["size_m"]), np.asarray(item["position"]), turn)]))
    return things
