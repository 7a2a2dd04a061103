"""What a robot drives to: goals of a decision, of the start, of its own tour, and the way home. Each is told."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from coral.advisor.clock import SimulatedClock, WallClock
from coral.advisor.question import Rejection
from coral.reef.decide.planner import AskedState, HighLevelPlanner
from coral.reef.decide.route import Goal
from coral.reef.map.belief import Belief
from coral.reef.pilot.consultation import Decided
from coral.reef.pilot.leftover import chain_of
from coral.reef.pilot.pilot_cfg import PilotCfg
from coral.reef.world.geometry import Pose, to_world

SURVEY_ENDED = "the advisor ended the survey"
GONE = "the map shows no oysters there any more"


class Goals:
    """Puts goals on the route behind those that were under way when a decision was asked for."""

    def __init__(
        self,
        belief: Belief,
        planner: HighLevelPlanner,
        clock: SimulatedClock | WallClock,
        emit: Callable[..., None],
        new_goal: Callable[[], None],
        cfg: PilotCfg,
    ) -> None:
        """Set up those of one robot; `new_goal` is told where the goal at hand is a new one."""
        self._belief, self._planner, self._clock, self._cfg = belief, planner, clock, cfg
        self._emit, self._new_goal, self._route = emit, new_goal, planner.route

    def begin(self, pose: Pose, t: float) -> None:
        """Drive to the initial waypoint: far enough ahead to drive while the first answer is awaited."""
        cfg, route = self._cfg, self._planner.cfg.route
        way_m = cfg.initial_m
        if route.ahead:
            way_m = max(way_m, min(self._route.lead_s * route.cruise_m_s, cfg.blind_m))
        while way_m > cfg.initial_m and not self._belief.map.contains(*to_world(pose, way_m, 0.0), margin_m=1.0):
            way_m -= 0.5
        self.go_to(*to_world(pose, way_m, 0.0), t, source="initial", reason="initial waypoint")

    def go_home(self, x: float, y: float, t: float) -> None:
        """Drive to a point (m) around what is on the map."""
        self.go_to(x, y, t, source="home", reason="the way home")

    def go_to(self, x: float, y: float, t: float, *, source: str, reason: str) -> None:
        """Drive to a point (m) that nobody decided on, and to nothing else."""
        self._route.follow([Goal(x=x, y=y)], t)
        self._emit("goal", x=x, y=y, source=source, decision=None, index=None, reason=reason, violates=False)

    def explore(self, asked: AskedState, goal: Goal) -> None:
        """Go on to the next unexplored place of the robot's own tour, as the advisor has said."""
        reason = "unexplored water comes next in the robot's own tour, to which the advisor left the rest"
        more = {"violates": False, "centroids": chain_of(asked.outlook.belief)}
        self._follow(asked, [goal], source="tour", decision=None, index=None, reason=reason, **more)

    def _follow(self, asked: AskedState, goals: list[Goal], **fields: Any) -> None:
        """Put goals behind those that were under way, and tell the first of them with the fields of its event."""
        before, (goal, *onward) = self._before(asked), goals
        if not before:
            self._new_goal()
        self._route.follow([*before, *goals], self._clock.now())
        then = [g.index if g.index is not None else [round(g.x, 3), round(g.y, 3)] for g in onward]
        waits = {"waits": len(before)} if before else {}
        at = {"x": round(goal.x, 3), "y": round(goal.y, 3)}
        self._emit("goal", **at, **fields, **waits, **({"then": then} if then else {}))

    def hold(self, number: int, reason: str) -> None:
        """Keep the present goal, which also is a decision, and not the advisor's."""
        self._emit("held", source="fallback", decision=number, reason=reason)

    def end(self, decided: Decided, asked: AskedState, t: float) -> bool:
        """End the survey with an answer; a mission in words ends where the robot was to be when it was needed."""
        answer, arrival = decided.answer, asked.outlook.arrival
        said = {"answer": answer.answer, **self._heard(asked, answer)} if hasattr(answer, "answer") else {}
        drives = bool(said) and arrival.in_s > 0.0
        if drives:
            self._route.follow([*self._before(asked), Goal(x=arrival.pose.x, y=arrival.pose.y)], t)
        self._emit("held", source=decided.source, decision=decided.number, reason=SURVEY_ENDED, **said)
        return drives

    def adopt(self, decided: Decided, asked: AskedState) -> None:
        """Put what was chosen behind the goals that were under way; without `ahead` there are none."""
        answer, planner = decided.answer, self._planner
        if decided.source == "fallback" and getattr(answer, "explore_rest", False):
            answer = answer.model_copy(update={"explore_rest": False})  # it stands in for one answer, not for the rest
        goal = planner.locate(asked, answer)
        if goal is None or isinstance(goal, Rejection):
            label = getattr(answer, "selected_centroid_index", getattr(answer, "dot", None))
            self._belief.last_failure = (label, GONE)
            heard = self._heard(asked, answer)
            self._emit("held", source=decided.source, decision=decided.number, reason=f"dot {label}: {GONE}", **heard)
            return
        onward, reason = planner.onward(asked, answer), getattr(answer, "reason", "")
        told = {"source": decided.source, "decision": decided.number, "index": goal.index, "reason": reason}
        self._follow(asked, [goal, *onward], **told, **planner.adopt(asked, answer, goal))

    def _before(self, asked: AskedState) -> list[Goal]:
        """Return the goals under way that were so when the question was asked."""
        return [goal for goal in self._route.goals if goal in asked.outlook.arrival.goals]

    def _heard(self, asked: AskedState, answer: Any) -> dict[str, Any]:
        """Keep what an answer in a mission in words says of things, where no goal comes of it."""
        pose = asked.outlook.arrival.pose
        return self._planner.adopt(asked, answer, Goal(x=pose.x, y=pose.y)) if hasattr(answer, "answer") else {}
