"""The high-level planner: what to ask, in which mode, and whether the answer may be driven to (paper III-C, Alg. 2)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from coral.advisor.question import Picture, Question, Rejection
from coral.reef.answers import CentroidChoice, WaypointChoice
from coral.reef.belief import Belief
from coral.reef.costfield import CostFieldCfg
from coral.reef.geometry import to_robot, to_world, wrap
from coral.reef.survey import Survey, SurveyCfg, survey
from coral.reef.trigger import separated
from coral.reef.verify import Surroundings, VerifyCfg, reference, verify_waypoint, violation

Mode = Literal["centroid", "waypoint"]
Prompts = Callable[[str, Mapping[str, Any]], tuple[str, str]]
"""Renders the prompt of a question kind from its context; returns (text, version)."""
Draw = Callable[[Belief], tuple[Picture, ...]]

KIND: dict[Mode, str] = {"centroid": "reef-centroid", "waypoint": "reef-waypoint"}


@dataclass(frozen=True, kw_only=True)
class PlannerCfg:
    """Mode switching and waypoint options."""

    forward_m: float = 1.0
    """d_min of Alg. 2: a centroid counts as ahead from this forward projection."""
    step_m: int = 6
    """Longest waypoint step per axis (paper III-C.2: whole metres, 0 to 6)."""
    separation_m: float = 1.0
    """Delta d_min: a new goal lies at least this far from the previous one (paper IV-F)."""
    centroid_selection: bool = True
    """False is the ablation "w/o centroid selection": the chain is shown, but only waypoints are asked for."""
    survey: SurveyCfg = field(default_factory=SurveyCfg)
    verify: VerifyCfg = field(default_factory=VerifyCfg)


@dataclass(frozen=True, kw_only=True)
class Goal:
    """A waypoint in the world (m), and the centroid label it stands for (None: a free waypoint)."""

    x: float
    y: float
    index: int | None = None


class HighLevelPlanner:
    """Turns the belief into questions and answers into verified goals."""

    def __init__(self, belief: Belief, fields: CostFieldCfg, prompts: Prompts, draw: Draw,
                 cfg: PlannerCfg | None = None) -> None:
        self.belief, self.fields, self.prompts, self.draw = belief, fields, prompts, draw
        self.cfg = cfg or PlannerCfg()
        self.survey: Survey | None = None
        self.mode: Mode = "centroid"
        self.finished = False
        """Nothing is left that the robot could visit or explore."""

    def observe(self, rejections: Sequence[Rejection]) -> Question[Any] | None:
        """Make the question from the map as it is now; None when nothing is left to choose."""
        left = self.survey = survey(self.belief, self.fields, self.cfg.forward_m, self.cfg.survey)
        reachable = [t for t in self.belief.unvisited() if math.isfinite(left.path_m(t.x, t.y))]
        if not reachable and not left.frontiers:
            self.finished = True
            return None
        self.mode = self._mode(left, bool(reachable))
        facts = self._facts(left)
        context = {"facts": facts, "rejections": [r.reason for r in rejections], "step_m": self.cfg.step_m}
        prompt, version = self.prompts(KIND[self.mode], context)
        return Question(kind=KIND[self.mode], prompt=prompt, prompt_version=version, facts=facts,
                        answer_type=CentroidChoice if self.mode == "centroid" else WaypointChoice,
                        pictures=self.draw(self.belief))

    def _mode(self, left: Survey, reachable: bool) -> Mode:
        """Autonomous mode switching (paper III-C.3)."""
        if not self.cfg.centroid_selection or not reachable:
            return "waypoint"
        return "centroid" if self.belief.ahead(self.cfg.forward_m) or left.dead_end else "waypoint"

    def locate(self, question: Question[Any], answer: CentroidChoice | WaypointChoice) -> Goal | Rejection:
        """The point in the world that an answer means."""
        if isinstance(answer, CentroidChoice):
            track = next((t for t in self.belief.tracks if t.index == answer.selected_centroid_index), None)
            if track is None:
                labels = ", ".join(str(t.index) for t in sorted(self.belief.tracks, key=lambda t: t.index))
                return Rejection(code="no-such-centroid", details={"index": answer.selected_centroid_index},
                                 reason=f"There is no orange dot {answer.selected_centroid_index} on the map. "
                                        f"The labels on the map are: {labels or 'none'}.")
            return Goal(x=track.x, y=track.y, index=track.index)
        asked_at = question.facts["robot"]
        c, s = math.cos(asked_at["theta"]), math.sin(asked_at["theta"])
        return Goal(x=asked_at["x"] + c * answer.forward_m - s * answer.left_m,
                    y=asked_at["y"] + s * answer.forward_m + c * answer.left_m)

    def verify(self, question: Question[Any], answer: CentroidChoice | WaypointChoice) -> Rejection | None:
        """Check an answer against the map as it is now, at response time (paper III-D)."""
        goal = self.locate(question, answer)
        if isinstance(goal, Rejection):
            return goal
        refusal = self._refuse(goal)
        if refusal is None:
            return None
        extra = {"index": goal.index} if isinstance(answer, CentroidChoice) else {
            "forward_m": answer.forward_m, "left_m": answer.left_m}
        return Rejection(code=refusal.code, reason=refusal.reason, details={**refusal.details, **extra})

    def _refuse(self, goal: Goal) -> Rejection | None:
        belief, cfg = self.belief, self.cfg
        left = survey(belief, self.fields, cfg.forward_m, cfg.survey)
        if not belief.map.contains(goal.x, goal.y):
            return Rejection(code="outside", reason="The chosen point lies outside the survey area.")
        if not math.isfinite(left.path_m(goal.x, goal.y)):
            return Rejection(code="blocked", reason="The chosen point lies inside an obstacle, or obstacles cut it "
                                                    "off. Choose a point in open water.")
        if not separated((goal.x, goal.y), (belief.pose.x, belief.pose.y), cfg.separation_m):
            return Rejection(code="too-close", reason=f"The chosen point is within {cfg.separation_m:g} m of the robot. "
                                                      "Choose one that makes progress.")
        if goal.index is not None and next(t.visited for t in belief.tracks if t.index == goal.index):
            return Rejection(code="visited", reason=f"Orange dot {goal.index} has been visited already: the yellow "
                                                    "trajectory passes it. Choose one that has not.") \
                if cfg.verify.enabled else None
        around = self._surroundings(left)
        return verify_waypoint((goal.x, goal.y), around, cfg.verify) if cfg.verify.enabled else None

    def adopt(self, goal: Goal) -> bool:
        """Make a goal the active one; True if it violates Eqs. 4-8 and no exemption applies (a "deviation")."""
        left = survey(self.belief, self.fields, self.cfg.forward_m, self.cfg.survey)
        around = self._surroundings(left)
        self.belief.goal = (goal.x, goal.y)
        return not around.dead_end and violation((goal.x, goal.y), around, self.cfg.verify) is not None

    def _surroundings(self, left: Survey) -> Surroundings:
        """What the verifiers judge by now. Where nothing that is left would pass, turning round is allowed."""
        belief, cfg = self.belief, self.cfg.verify
        around = Surroundings(pose=belief.pose, previous=belief.goal, dead_end=False,
                              ahead=[(t.x, t.y) for t in belief.ahead(cfg.forward_m)],
                              chain=[(t.x, t.y) for t in belief.tracks])
        aims = [(t.x, t.y) for t in belief.unvisited() if math.isfinite(left.path_m(t.x, t.y))]
        if self.mode == "waypoint":
            aims += [to_world(belief.pose, o["forward_m"], o["left_m"]) for o in self._options(left)]
        open_ = any(violation(p, around, cfg) is None for p in aims if separated(p, belief.pose[:2], 1.5))
        return replace(around, dead_end=left.dead_end or not open_)

    def _facts(self, left: Survey) -> dict[str, Any]:
        belief, pose = self.belief, self.belief.pose
        around = self._surroundings(left)
        trail = belief.trajectory
        centroids = []
        for position, t in enumerate(belief.tracker.chain()):
            forward, to_left = to_robot(pose, t.x, t.y)
            centroids.append({
                "index": t.index, "forward_m": round(forward, 2), "left_m": round(to_left, 2),
                "bearing_deg": round(math.degrees(math.atan2(to_left, forward)), 1),
                "path_m": _finite(left.path_m(t.x, t.y)), "visited": t.visited, "chain_position": position,
                "failed_attempts": belief.failures(t.x, t.y), "area_m2": round(t.area_px * belief.map.cfg.cell_m**2, 2),
                "trajectory_m": _finite(float(np.min(np.hypot(trail[:, 0] - t.x, trail[:, 1] - t.y)))),
                "unexplored": round(belief.map.unexplored_share(t.x, t.y, self.cfg.survey.gain_radius_m), 3)})
        frontiers = []
        for f in left.frontiers[:40]:
            forward, to_left = to_robot(pose, f.x, f.y)
            frontiers.append({"forward_m": round(forward, 2), "left_m": round(to_left, 2), "path_m": round(f.path_m, 2),
                              "bearing_deg": round(math.degrees(f.bearing), 1), "length_m": round(f.length_m, 2),
                              "unexplored": round(f.unexplored, 3), "reef_m": _finite(f.reef_m)})
        facts: dict[str, Any] = {
            "robot": {"x": pose.x, "y": pose.y, "theta": pose.theta}, "arrival": self._arrival(), "area_m": list(belief.map.size_m),
            "dead_end": around.dead_end, "trend_deg": self._trend(around), "centroids": centroids, "frontiers": frontiers}
        if self.mode == "waypoint":
            facts["options"] = self._options(left)
        return facts

    def _arrival(self) -> dict[str, float]:
        """Where the robot will be when the answer comes, in its present frame: at the goal that it is driving to."""
        goal = self.belief.goal
        if goal is None:
            return {"forward_m": 0.0, "left_m": 0.0, "heading_deg": 0.0}
        forward, to_left = to_robot(self.belief.pose, *goal)
        heading = math.degrees(math.atan2(to_left, forward)) if math.hypot(forward, to_left) > 0.5 else 0.0
        return {"forward_m": round(forward, 2), "left_m": round(to_left, 2), "heading_deg": round(heading, 1)}

    def _trend(self, around: Surroundings) -> float | None:
        """Bearing of the chain's trend (deg, Eq. 7), as the blue line on the map shows it; None when it says nothing."""
        found = reference(around, self.cfg.verify)
        if found is None or len(around.chain) < self.cfg.verify.min_centroids:
            return None
        return round(math.degrees(wrap(math.atan2(found[0][1], found[0][0]) - around.pose.theta)), 1)

    def _options(self, left: Survey) -> list[dict[str, Any]]:
        """The discrete waypoints that can be reached, with what each would show and how far each frontier is from it."""
        belief, n = self.belief, self.cfg.step_m
        steps = [(f, s) for f in range(-n, n + 1) for s in range(-n, n + 1) if math.hypot(f, s) >= self.cfg.separation_m]
        points = [to_world(belief.pose, f, s) for f, s in steps]
        paths = left.paths_m(np.array([p[0] for p in points]), np.array([p[1] for p in points]))
        return [{"forward_m": f, "left_m": s, "path_m": round(float(path), 2),
                 "unexplored": round(belief.map.unexplored_share(x, y, self.cfg.survey.gain_radius_m), 3)}
                for (f, s), (x, y), path in zip(steps, points, paths, strict=True)
                if math.isfinite(path) and belief.map.contains(x, y)]


def _finite(value: float) -> float | None:
    return round(value, 2) if math.isfinite(value) else None
