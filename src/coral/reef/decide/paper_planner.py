"""Algorithm 2 of the paper: choose the mode, ask, verify, ask again with the failure mode (III-C, III-D)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from coral.advisor.question import Rejection
from coral.reef.decide.answers import CentroidAnswer, WaypointAnswer
from coral.reef.decide.facts import describe, waypoint_options
from coral.reef.decide.outlook import Outlook
from coral.reef.decide.planner import Answer, AskedState, HighLevelPlanner, Mode
from coral.reef.decide.questions import (
    KINDS,
    PAPER,
    chosen,
    goal_of_dot,
    goal_of_step,
    make_question,
    outside,
    surroundings,
)
from coral.reef.decide.route import Goal
from coral.reef.decide.survey import survey
from coral.reef.decide.trigger import separated
from coral.reef.decide.verify import behind_robot, verify_waypoint
from coral.reef.map.costfield import CostField
from coral.reef.world.geometry import Pose


class PaperPlanner(HighLevelPlanner):
    """Asks as Alg. 2 does: near the goal, measured from the robot, one goal at a time."""

    def outlook(self, way: CostField | None = None) -> Outlook:
        """Freeze what the robot knows now; it is asked from where it is."""
        return replace(Outlook.now(self.belief.snapshot()), under_way=bool(self.route.goals))

    def ask(self, outlook: Outlook, rejections: Sequence[Rejection] = ()) -> AskedState:
        """Choose the mode and make the question (Alg. 2, lines 1-10)."""
        cfg = self.cfg
        left = survey(outlook, self.fields, cfg.forward_m, cfg.survey)
        left = left if cfg.explore else replace(left, frontiers=())
        around = surroundings(outlook, left, cfg.forward_m)
        mode: Mode = "centroid" if around.ahead and cfg.centroid_selection else "waypoint"
        asked = AskedState(question=None, mode=mode, outlook=outlook, left=left, around=around)
        if not left.frontiers and not any(math.isfinite(left.path_m(t.x, t.y)) for t in outlook.unvisited()):
            return replace(asked, finished=not outlook.under_way)
        facts = describe(outlook, left, None)
        if mode == "waypoint":
            pose = outlook.arrival.pose
            facts["options"] = waypoint_options(outlook.belief, left, pose, cfg.step_m, cfg.separation_m)
        question = make_question(
            mode,
            KINDS[mode] + PAPER,
            CentroidAnswer if mode == "centroid" else WaypointAnswer,
            facts,
            outlook,
            cfg,
            self.draw,
        )
        return replace(asked, question=question)

    def verify(self, asked: AskedState, answer: Answer) -> Rejection | None:
        """Check the point that was chosen (Alg. 2, lines 11-15)."""
        goal = self.locate(asked, answer)
        if goal is None or isinstance(goal, Rejection):
            return goal
        refusal = outside(goal, self.belief) or (
            self._refuse(asked, goal, self.belief.pose) if self.cfg.checks else None
        )
        return None if refusal is None else replace(refusal, details={**refusal.details, **chosen(answer)})

    def _refuse(self, asked: AskedState, goal: Goal, now: Pose) -> Rejection | None:
        p, cfg = (goal.x, goal.y), self.cfg
        if not separated(p, asked.outlook.belief.goal, cfg.separation_m):
            return Rejection(code="too-close", reason="The chosen point is the previous target, or too near to it.")
        refusal = verify_waypoint(p, asked.around, cfg.verify)
        if refusal is None and asked.around.ahead and behind_robot(p, now, cfg.verify):
            # Eq. 4 holds at the time of the response, too: the robot has moved while the model thought.
            return Rejection(code="behind-robot", reason="The chosen point is behind the robot by now.")
        return refusal

    def locate(self, asked: AskedState, answer: Answer) -> Goal | Rejection | None:
        """Return the point in the world that an answer means."""
        if isinstance(answer, CentroidAnswer):
            return goal_of_dot(asked, answer.selected_centroid_index, self.belief)
        return goal_of_step(asked, answer.forward_m, answer.left_m)

    def adopt(self, asked: AskedState, answer: Answer, goal: Goal) -> dict[str, Any]:
        """Count a deviation (IV-E): a goal that violates Eqs. 4-8, as it was asked for."""
        return {"violates": verify_waypoint((goal.x, goal.y), asked.around, self.cfg.verify) is not None}
