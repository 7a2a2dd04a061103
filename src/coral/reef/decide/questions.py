"""How a question is put together and what its answer means, for every planner."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from pydantic import BaseModel

from coral.advisor.prompt import render
from coral.advisor.question import Question, Rejection
from coral.reef.decide.answers import CentroidAnswer
from coral.reef.decide.outlook import Outlook
from coral.reef.decide.planner import Answer, AskedState, Draw, PlannerCfg
from coral.reef.decide.route import Goal
from coral.reef.decide.survey import Survey
from coral.reef.decide.verify import Surroundings
from coral.reef.map.belief import Belief
from coral.reef.map.chain import nearest_track
from coral.reef.world.geometry import to_world

KINDS = {"centroid": "reef-centroid", "waypoint": "reef-waypoint", "mission": "reef-mission"}
PAPER = "-paper"
"""End of the names of the paper's prompts."""
WITHOUT_CHAIN = "reef-waypoint-without-chain"
"""Prompt of a robot that extracts no clusters; it asks for the same as "reef-waypoint"."""


def make_question(
    mode: str,
    template: str,
    answer_type: type[BaseModel],
    facts: Mapping[str, Any],
    outlook: Outlook,
    cfg: PlannerCfg,
    draw: Draw,
) -> Question[Any]:
    """Render a question."""
    belief = outlook.belief
    context = {"facts": facts, "step_m": cfg.step_m, "latency_s": outlook.latency_s, "inspect_m": belief.inspect_m}
    prompt, version = render(template if belief.cfg.centroids else WITHOUT_CHAIN, context)
    return Question(
        kind=KINDS[mode],
        prompt=prompt,
        prompt_version=version,
        facts=facts,
        answer_type=answer_type,
        pictures=draw(outlook),
    )


def surroundings(outlook: Outlook, left: Survey, forward_m: float) -> Surroundings:
    """Return the inputs of Eqs. 4-8."""
    belief = outlook.belief
    return Surroundings(
        pose=outlook.arrival.pose,
        previous=belief.goal,
        dead_end=left.dead_end,
        ahead=[(t.x, t.y) for t in outlook.ahead(forward_m)],
        chain=[(t.x, t.y) for t in belief.tracks],
    )


def goal_of_dot(asked: AskedState, index: int | None, now: Belief) -> Goal | Rejection | None:
    """Return the cluster that a label meant when it was asked for, where it is now; None if it has vanished since.

    A cluster that has got another label since (it merged, or the map shows what was seen from afar) is found by its
    place.
    """
    outlook = asked.outlook
    meant = outlook.belief.track(index)
    if meant is None:
        what = "The answer names no dot." if index is None else f"There is no dot {index} on the map."
        left = sorted(track.index for track in outlook.belief.tracks if not outlook.done(track))
        return Rejection(
            code="no-such-centroid",
            details={"index": index},
            reason=f"{what} Dots that are left: {', '.join(map(str, left)) or 'none'}.",
        )
    reach_m = now.cfg.chain.far_merge_m if meant.far else now.cfg.chain.merge_distance_m
    track = now.track(meant.index) or nearest_track(now.tracks, meant.x, meant.y, reach_m)
    return None if track is None else Goal(x=track.x, y=track.y, index=track.index)


def goal_of_step(asked: AskedState, forward_m: float, left_m: float) -> Goal:
    """Return the waypoint that metres ahead and to the left meant when they were asked for."""
    x, y = to_world(asked.outlook.arrival.pose, forward_m, left_m)
    return Goal(x=x, y=y)


def chosen(answer: Answer) -> dict[str, Any]:
    """Return what an answer chose, for the details of its refusal."""
    if isinstance(answer, CentroidAnswer):
        return {"index": answer.selected_centroid_index}
    return {"forward_m": answer.forward_m, "left_m": answer.left_m}


def outside(goal: Goal, now: Belief) -> Rejection | None:
    """Refuse a goal that no map covers."""
    if now.map.contains(goal.x, goal.y):
        return None
    return Rejection(code="outside", reason="The chosen point lies outside the survey area.")


def option_points(asked: AskedState, options: Sequence[Mapping[str, Any]]) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Return the places of waypoints on offer. Shape=(N, 2), metres."""
    pose = asked.outlook.arrival.pose
    return np.array([to_world(pose, o["forward_m"], o["left_m"]) for o in options], np.float64).reshape(-1, 2)
