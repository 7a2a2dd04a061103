"""Decision points of a reef mission: the robot is moved through a world picture by picture, without a controller."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.advisor.consult import consult_at_once
from coral.advisor.prompt import render
from coral.advisor.question import Question
from coral.advisor.rules import RuleAdvisor
from coral.reef.decide.answers import CentroidChoice, WaypointChoice
from coral.reef.decide.asked import AskedState
from coral.reef.decide.baselines import baseline_rules
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.decide.planner import HighLevelPlanner
from coral.reef.decide.route import Goal
from coral.reef.decide.tour_planner import TourPlanner
from coral.reef.map.belief import Belief, BeliefCfg
from coral.reef.map.costfield import CostField, CostFieldCfg
from coral.reef.map.mapping import MapCfg, OccupancyMap
from coral.reef.pictures.questions import question_pictures
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.vehicle.vehicle import VehicleCfg
from coral.reef.world.geometry import Pose, to_world, wrap
from coral.reef.world.scene import Scene
from coral.reef.world.world import ReefWorld

STEP_M, TURN_RAD = 0.3, 0.35
"""Distance driven and angle turned between two pictures."""
ASK_M = 2.5
"""The next goal is asked for at this distance from the present one: D_trig of the paper."""
REACHED_M = 1.0
"""A waypoint is reached this near to it."""
SEEN_M = 0.5
"""The robot drives on to a cluster with something left to see until it is this near."""
LATEST_S = 400.0
LOST_S = 5.0
"""What a goal costs that leads nowhere."""
WAYWARD = 0.35
"""Share of random goals, so that the set has situations to which the rules do not lead."""


@dataclass(frozen=True)
class Moment:
    """A question, where it came up, and the goal that each answer means."""

    question: Question[Any]
    """As an advisor receives it."""
    pose: Pose
    """Pose of the robot."""
    left: tuple[int, ...]
    """Indices of the true clusters that the robot has not come near yet."""
    options: dict[str, tuple[float, float] | str]
    """Goal (m) of each answer (label of a dot, or metres ahead and to the left), or the verifiers' code of refusal."""


class LedPlanner(TourPlanner):
    """Evaluates every answer to a question."""

    def options(self, asked: AskedState) -> dict[str, tuple[float, float] | str]:
        """Return the goal of each answer, as in `Moment.options`."""
        assert asked.question is not None
        if asked.mode == "centroid":
            dots = [CentroidChoice(selected_centroid_index=track.index) for track in self.belief.tracks]
            return {str(dot.selected_centroid_index): self._means(asked, dot) for dot in dots}
        steps = [WaypointChoice(forward_m=o["forward_m"], left_m=o["left_m"]) for o in asked.question.facts["options"]]
        return {f"{step.forward_m},{step.left_m}": self._means(asked, step) for step in steps}

    def _means(self, asked: AskedState, answer: CentroidChoice | WaypointChoice) -> tuple[float, float] | str:
        refusal = self.verify(asked, answer)
        goal = self.locate(asked, answer)
        if refusal is not None or not isinstance(goal, Goal):
            return refusal.code if refusal is not None else "no-such-centroid"
        return goal.x, goal.y


def moments(
    world: ReefWorld, clusters: NDArray[np.float64], rng: np.random.Generator, near_m: float
) -> Iterator[Moment]:
    """Yield the questions along one path through a world, until no cluster is left or time is up.

    Args:
        world: World to survey.
        clusters: True centres of its clusters (m). Shape=(C, 2).
        rng: Draws the random goals.
        near_m: A cluster counts as inspected within this distance.
    """
    camera = Camera(Scene.from_world(world), CameraCfg())
    belief = Belief(OccupancyMap(world.size_m, CameraCfg(), MapCfg()), BeliefCfg(chain_period=1))
    planner = LedPlanner(belief, CostFieldCfg(), render, question_pictures)
    guides = [RuleAdvisor(REEF_RULES), RuleAdvisor(baseline_rules("random", rng))]
    visited: set[int] = set()
    t = 0.0

    def look(pose: Pose) -> None:
        belief.update(camera.render(pose), pose)
        visited.update(np.flatnonzero(np.hypot(*(clusters - (pose.x, pose.y)).T) <= near_m).tolist())

    look(Pose(world.start.x, world.start.y, world.start.theta))
    belief.goal = to_world(belief.pose, 2.0, 0.0)
    while t < LATEST_S and len(visited) < len(clusters):
        before = t
        for pose in drive(belief):
            t += seconds_of(belief.pose, pose)
            look(pose)
        if t == before:  # nothing came of this goal: what is left of it cannot be seen, or lies out of reach
            t += LOST_S
            give_up(belief)
        asked = planner.ask(planner.outlook())
        question = asked.question
        if question is None:
            return
        left = tuple(k for k in range(len(clusters)) if k not in visited)
        if left:
            yield Moment(
                Question(**{**vars(question), "asked_at_s": round(t, 1)}), belief.pose, left, planner.options(asked)
            )
        goal = choose_goal(planner, asked, guides[int(rng.random() < WAYWARD)])
        if goal is None:
            return
        belief.goal, belief.goal_index = (goal.x, goal.y), goal.index


def choose_goal(planner: HighLevelPlanner, asked: AskedState, guide: RuleAdvisor) -> Goal | None:
    """Return a goal that the verifiers accept."""
    answer = consult_at_once(
        guide, lambda _: asked.question, lambda _, answer: planner.verify(asked, answer), tries=8
    ).answer
    goal = None if answer is None else planner.locate(asked, answer)
    return goal if isinstance(goal, Goal) else None


def drive(belief: Belief) -> Iterator[Pose]:
    """Yield poses towards the goal until the next question; replan as the map grows."""
    for _ in range(30):
        goal, here = belief.goal, belief.pose
        assert goal is not None
        if math.dist(goal, here[:2]) <= _enough_m(belief):
            return
        field = CostField.compute(belief.map.distance(), goal, start=here[:2], cell_m=belief.map.cfg.cell_m)
        if not field.ok:
            belief.goal_failed()
            return
        path = field.path_from(here.x, here.y, step_m=STEP_M, length_m=2.0)
        if len(path) < 2:
            return
        for x, y in path[1:].tolist():
            theta = math.atan2(y - belief.pose.y, x - belief.pose.x)
            turn = wrap(theta - belief.pose.theta)
            for _ in range(1, math.ceil(abs(turn) / TURN_RAD)):
                yield belief.pose._replace(theta=wrap(belief.pose.theta + math.copysign(TURN_RAD, turn)))
            yield Pose(x, y, theta)
            if math.dist(goal, (x, y)) <= _enough_m(belief):
                return


def _enough_m(belief: Belief) -> float:
    """Return how near to its goal the robot has to come (m)."""
    if belief.goal_index is None:
        return REACHED_M
    track = belief.track(belief.goal_index)
    return ASK_M if track is None or track.visited else SEEN_M


def give_up(belief: Belief) -> None:
    """Give up a goal that leads nowhere."""
    belief.goal_failed()
    if belief.goal_index is not None:
        belief.write_off(belief.goal_index)


def seconds_of(before: Pose, after: Pose) -> float:
    """Return how long the way from one pose to the next takes at full speed (s)."""
    cfg = VehicleCfg()
    turned = abs(wrap(after.theta - before.theta)) / cfg.max_yaw_rate_rad_s
    return math.dist(before[:2], after[:2]) / cfg.max_speed_m_s + turned
