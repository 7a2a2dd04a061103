"""What is refused: hazards, places out of reach, ways back that the robot's own record proves finished, contradictions.

Nothing here plans a tour: to differ from the robot's own plan is no fault. Beyond the paper, which refuses by fixed
angles (`verify.py`).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from coral.advisor.question import Rejection
from coral.reef.decide.answers import CentroidChoice, Expectation, WaypointChoice
from coral.reef.decide.outlook import Outlook
from coral.reef.decide.planner import AskedState
from coral.reef.decide.route import Goal
from coral.reef.decide.topology import Remaining
from coral.reef.map.belief import Belief
from coral.reef.map.carried import around
from coral.reef.map.mapping import OccupancyMap
from coral.reef.map.water import Reach
from coral.reef.world.geometry import to_world

SEE_M = 3.0
"""A waypoint shows what lies within this of it."""
EXPLORED_SHARE = 0.03
"""Water of which no more than this share is unexplored shows nothing new."""
GREEN_M2 = 0.1
"""Nor do fewer oysters without a dot: single cells come and go with the noise of pictures."""
END_SHARE = 0.9
"""A cluster of which less than this has been seen must not be left behind at the end."""
END_REEF_M = 1.5
"""Nor unexplored water this near to known oysters."""
TOLERANCE_M = 0.3
"""A waypoint leads away if it is farther by this from everything that is left: twice the cell of the search."""
GUESS_M = 8.0
"""A goal that is chosen for a guess lies within this of it (the camera's range and 2 m), or on the way to it."""


def contradiction(asked: AskedState, answer: CentroidChoice | WaypointChoice, goal: Goal | None) -> str:
    """Return how an answer contradicts itself, or ""."""
    dot = answer.selected_centroid_index if isinstance(answer, CentroidChoice) else answer.dot
    if answer.end_survey and (dot is not None or answer.then):
        return "It ends the survey and names a goal as well. Do one of both."
    if isinstance(answer, CentroidChoice) and dot is not None and answer.waypoint is not None:
        return "It names a dot and a waypoint as well. Name one of both, and null for the other."
    if goal is not None and answer.expect is not None:
        place = expected_at(asked, answer.expect, goal)
        if not asked.outlook.belief.map.contains(*place):
            return "What it expects lies outside the survey area."
        away = math.dist(place, (goal.x, goal.y))
        if away > max(GUESS_M, math.dist(place, asked.outlook.arrival.pose[:2])):
            return "Its goal leads away from what it expects, which would not be seen from there."
    return ""


def expected_at(asked: AskedState, expect: Expectation, goal: Goal) -> tuple[float, float]:
    """Return the place (m, world) of a guess; without one of its own it is the goal's."""
    if expect.forward_m is None or expect.left_m is None:
        return goal.x, goal.y
    return to_world(asked.outlook.arrival.pose, expect.forward_m, expect.left_m)


def hazard(goal: Goal, reach: Reach) -> Rejection | None:
    """Refuse what obstacles stand in the way of on the map as it is now."""
    if not reach.reaches(goal.x, goal.y):
        return Rejection(
            code="blocked",
            reason="The chosen point lies inside an obstacle, or obstacles cut it off. Choose a point in open water.",
        )
    return None


def finished_dot(outlook: Outlook, index: int | None) -> Rejection | None:
    """Refuse a dot that had nothing left to see when it was asked for."""
    track = outlook.belief.track(index)
    if track is None or not outlook.done(track):
        return None
    how = "has been seen from near" if track.visited else "is the present goal, and done before your choice begins"
    return Rejection(code="visited", reason=f"Dot {index} is hollow: it {how}. Choose what comes after it.")


def leads_nowhere(
    outlook: Outlook, remaining: Remaining, xs: NDArray[np.float64], ys: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Tell at which points (m), Shape=(N,), all about is known and done, and nothing that is left is nearer."""
    if not len(remaining.places) or not len(xs):
        return np.zeros(len(xs), bool)
    cells, green = outlook.belief.map, _green(outlook.belief)
    at = zip(xs.tolist(), ys.tolist(), strict=True)
    shows = np.array(
        [cells.unexplored_share(x, y, SEE_M) > EXPLORED_SHARE or _lies_near(green, cells, x, y) for x, y in at]
    )
    for track in outlook.unvisited():
        shows |= np.hypot(xs - track.x, ys - track.y) <= SEE_M
    return np.asarray(~shows & ~remaining.nearer(xs, ys, outlook.arrival.pose[:2], TOLERANCE_M))


def _green(belief: Belief) -> NDArray[np.bool_]:
    """Return the oyster cells that belong to no dot and have not been seen from near. Shape=(NY, NX)."""
    cells = belief.map
    green: NDArray[np.bool_] = cells.target & (cells.nearest > belief.inspect_m) & ~cells.unseeable
    for track in belief.tracks:
        green[track.cells[:, 0], track.cells[:, 1]] = False
    return green


def _lies_near(green: NDArray[np.bool_], cells: OccupancyMap, x: float, y: float) -> bool:
    y0, y1, x0, x1 = around(x, y, SEE_M, cells.cfg.cell_m, green.shape)
    return bool(np.count_nonzero(green[y0:y1, x0:x1]) * cells.cfg.cell_m**2 >= GREEN_M2)


def too_early_to_end(asked: AskedState) -> Rejection | None:
    """Refuse the end of a survey while the map shows oysters to see, or water beside them where there may be more."""
    outlook = asked.outlook
    dots = [
        t.index
        for t in outlook.unvisited()
        if t.inspected < END_SHARE and not t.doubtful and math.isfinite(asked.left.path_m(t.x, t.y))
    ]
    water = [f for f in asked.left.frontiers if f.reef_m <= END_REEF_M]
    if not dots and not water and outlook.belief.tracks:
        return None
    left = f"dots {', '.join(map(str, sorted(dots)))}" if dots else "unexplored water beside known oysters"
    left = left if outlook.belief.tracks else "no oysters have been found yet, and unexplored water"
    return Rejection(code="not-done", reason=f"The survey cannot end yet. Left are: {left}.")
