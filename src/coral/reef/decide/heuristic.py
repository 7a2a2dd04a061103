"""The reef's rules for the embedded `heuristic` advisor: the paper's own priority rules, on `facts`.

Avoid what has been seen, prefer what lies near unexplored water, continue away from the trajectory, follow the
chain (paper III-C.1): here as one tour of everything that the map shows to be left. The rules measure the distances
between the places on the map as a reader of the picture would, straight. They are no language or vision model.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.advisor.question import Rejection
from coral.advisor.setting import Rule
from coral.reef.decide.answers import CentroidChoice, WaypointChoice, WaypointStep
from coral.reef.decide.topology import (
    DOT_WORTH,
    FAR_M2,
    GAP_M,
    MOST_PLACES,
    REEF_M,
    SPEED_M_S,
    YAW_RATE_RAD_S,
    frontier_worth,
)
from coral.reef.decide.wordless import Wordless
from coral.reef.vehicle.delays import delays_from, order_from

FAILED_S = 10.0
"""A goal that failed already is put off by so much."""
REFUSED_RAD = 0.5
"""A waypoint this near to the direction of a refused one is as wrong."""
SEEN_M = 3.0
"""A waypoint this near to a place shows it."""
NEW_M = 2.0
"""A further waypoint this near to the one before adds nothing."""
MOST_THEN = 2
"""Goals named besides the first, to continue with until the next answer comes."""

Fact = Mapping[str, Any]


@dataclass(frozen=True)
class _Place:
    """Something that is left to see, as seen on arrival."""

    forward_m: float
    left_m: float
    path_m: float
    worth: float
    name: str
    index: int | None = None
    put_off_s: float = 0.0


def choose_centroid(facts: Fact, rejections: Sequence[Rejection]) -> CentroidChoice:
    """Answer a centroid question: the dot that the best tour begins with, and those that follow it."""
    refused = {r.details.get("index") for r in rejections}
    places = _places(facts)
    dots = [k for k, place in enumerate(places) if place.index is not None]
    open_ = [k for k in dots if places[k].index not in refused] or dots
    if not open_:
        fresh = [c for c in facts["centroids"] if not c["visited"]] or list(facts["centroids"])
        if not fresh:
            return CentroidChoice(selected_centroid_index=None, reason="No cluster is on the map.")
        return CentroidChoice(selected_centroid_index=fresh[0]["index"], reason="No way to any cluster is known.")
    between, worth = _between(places)
    total = _first_s(places) + delays_from(between, worth)
    best = min(open_, key=lambda k: total[k])
    after = [k for k in order_from(best, between, worth)[1:] if places[k].index is not None]
    then = tuple(places[k].index for k in after[:MOST_THEN])
    place = places[best]
    why = (
        f"Cluster {place.index} is the best next stop: it lies {abs(place.forward_m):.1f} m "
        f"{'ahead' if place.forward_m >= 0 else 'behind'} and {abs(place.left_m):.1f} m to the "
        f"{'left' if place.left_m >= 0 else 'right'} of where the robot will be."
    )
    return CentroidChoice(selected_centroid_index=place.index, then=then, reason=why)


def choose_waypoint(facts: Fact, rejections: Sequence[Rejection]) -> WaypointChoice:
    """Answer a free waypoint question: a step towards the place that the best tour begins with."""
    refused = {(r.details.get("forward_m"), r.details.get("left_m")) for r in rejections}
    options = [o for o in facts["options"] if (o["forward_m"], o["left_m"]) not in refused]
    if not options:
        return WaypointChoice(forward_m=0, left_m=0, reason="No waypoint can be reached.")
    options = [o for o in options if not _like_refused(o, refused)] or options
    places = _places(facts)
    if not places:
        best = max(options, key=lambda o: (o["unexplored"], -o["path_m"]))
        return WaypointChoice(
            forward_m=best["forward_m"], left_m=best["left_m"], reason="Most unexplored water in reach."
        )
    between, worth = _between(places)
    total = _first_s(places) + delays_from(between, worth)
    order = order_from(int(np.argmin(total)), between, worth)
    aim = places[order[0]]
    best = min(options, key=lambda o: _detour(o, aim))
    steps = [best]
    for before, k in itertools.pairwise(order):
        step = min(options, key=lambda o: _detour(o, places[k], steps[-1]))
        passed = places[before]
        if math.dist(_at(steps[-1]), (passed.forward_m, passed.left_m)) > SEEN_M or len(steps) > MOST_THEN:
            break  # the step does not reach its place: what comes after it is for the next question
        if math.dist(_at(step), _at(steps[-1])) >= NEW_M:
            steps.append(step)
    rest = bool(facts["centroids"]) and all(place.index is None for place in places)
    why = "Nothing that is known is left: the rest by the robot's own tour." if rest else ""
    return WaypointChoice(
        forward_m=best["forward_m"],
        left_m=best["left_m"],
        then=tuple(WaypointStep(forward_m=o["forward_m"], left_m=o["left_m"]) for o in steps[1:]),
        explore_rest=rest,
        reason=why or f"Towards {aim.name}, {aim.path_m:.1f} m away.",
    )


def _detour(option: Fact, aim: _Place, start: Fact | None = None) -> float:
    """Return the length of the way over a waypoint to a place, the second part weighed more."""
    way = option["path_m"] if start is None else math.dist(_at(option), _at(start))
    rest = math.hypot(option["forward_m"] - aim.forward_m, option["left_m"] - aim.left_m)
    return float(way + 1.5 * rest - 0.5 * option["unexplored"])


def _at(option: Fact) -> tuple[float, float]:
    return option["forward_m"], option["left_m"]


def _like_refused(option: Fact, refused: set[tuple[Any, Any]]) -> bool:
    """Check whether a waypoint lies in about the direction of one that was refused."""
    bearing = math.atan2(option["left_m"], option["forward_m"])
    refusals = [math.atan2(left, forward) for forward, left in refused if forward is not None and left is not None]
    return any(abs(math.remainder(bearing - other, 2.0 * math.pi)) < REFUSED_RAD for other in refusals)


def _places(facts: Fact) -> list[_Place]:
    """Return what is left to see and within reach, nearest first, clusters before the rest."""
    dots = []
    for c in facts["centroids"]:
        if not (c["visited"] or c.get("doubtful")) and c["path_m"] is not None:
            worth = DOT_WORTH + (FAR_M2 if c["left_m2"] is None else c["left_m2"])
            dots.append(_place(c, worth, f"cluster {c['index']}", c["index"], c["failed_attempts"]))
    places = sorted(dots, key=lambda p: p.path_m)[:MOST_PLACES]
    for f in facts["frontiers"]:
        reef_m = math.inf if f["reef_m"] is None else f["reef_m"]
        name = "unexplored water beside the reef" if reef_m <= REEF_M else "unexplored water"
        place = _place(f, frontier_worth(reef_m, f["unexplored"]), name)
        if len(places) == MOST_PLACES:
            break
        if all(_apart(place, p) >= GAP_M for p in places if p.index is None):
            places.append(place)
    return places


def _place(at: Fact, worth: float, name: str, index: int | None = None, failed: int = 0) -> _Place:
    return _Place(at["forward_m"], at["left_m"], at["path_m"], worth, name, index, FAILED_S * failed)


def _apart(a: _Place, b: _Place) -> float:
    return math.hypot(a.forward_m - b.forward_m, a.left_m - b.left_m)


def _first_s(places: Sequence[_Place]) -> NDArray[np.float64]:
    """Return the time to each place from where the robot will be (s). Shape=(N,)."""
    turn = np.array([abs(math.atan2(p.left_m, p.forward_m)) for p in places]) / YAW_RATE_RAD_S
    return np.asarray(turn + np.array([p.path_m / SPEED_M_S + p.put_off_s for p in places]), np.float64)


def _between(places: Sequence[_Place]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the times between places (s), Shape=(N, N), and their worth, Shape=(N,)."""
    at = np.array([(p.forward_m, p.left_m) for p in places])
    return np.hypot(*(at[:, None] - at[None]).transpose(2, 0, 1)) / SPEED_M_S, np.array([p.worth for p in places])


REEF_RULES: dict[str, Rule] = {
    "reef-centroid": choose_centroid,
    "reef-waypoint": choose_waypoint,
    "reef-mission": Wordless(),
}
