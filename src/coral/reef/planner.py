"""The high-level planner: what to ask, in which mode, and whether the answer is admissible (paper III-C, Alg. 2)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from coral.advisor.question import Picture, Question, Rejection
from coral.config import Count
from coral.reef.answers import CentroidChoice, WaypointChoice
from coral.reef.belief import Belief
from coral.reef.costfield import CostFieldCfg
from coral.reef.facts import describe, waypoint_options
from coral.reef.geometry import to_world
from coral.reef.survey import Survey, SurveyCfg, survey
from coral.reef.topology import TopologyCfg, places_left
from coral.reef.trigger import separated
from coral.reef.verify import Surroundings, VerifyCfg, verify_waypoint, violation

Mode = Literal["centroid", "waypoint"]
Prompts = Callable[[str, Mapping[str, Any]], tuple[str, str]]
"""Renders the prompt of a question kind from its context; returns (text, version)."""
Draw = Callable[[Belief], tuple[Picture, ...]]

KIND: dict[Mode, str] = {"centroid": "reef-centroid", "waypoint": "reef-waypoint"}
WITHOUT_CHAIN = "reef-waypoint-without-chain"
"""Prompt of a robot that extracts no clusters; it asks for the same as "reef-waypoint"."""


@dataclass(frozen=True, kw_only=True)
class PlannerCfg:
    """Mode switching and waypoint options."""

    forward_m: float = 1.0
    """d_min of Alg. 2: a centroid counts as ahead from this forward projection."""
    step_m: Count = 6
    """Longest waypoint step per axis (paper III-C.2: whole metres, 0 to 6)."""
    separation_m: float = 1.0
    """Delta d_min (paper IV-F, there from the previous goal): a new goal lies at least this far from the robot."""
    checks: bool = True
    """Whether a goal must be in open water within reach, 1 m away, and no other robot's. False is for the ablation
    "w/o self-verification" and for DREAM: only points outside the survey area are refused, which no map covers."""
    centroid_selection: bool = True
    """False is the ablation "w/o centroid selection": the chain is shown, but only waypoints are asked for."""
    survey: SurveyCfg = field(default_factory=SurveyCfg)
    verify: VerifyCfg = field(default_factory=VerifyCfg)
    topology: TopologyCfg = field(default_factory=TopologyCfg)


@dataclass(frozen=True, kw_only=True)
class Goal:
    """A waypoint in the world (m), and the centroid label it stands for (None: a free waypoint)."""

    x: float
    y: float
    index: int | None = None


class HighLevelPlanner:
    """Turns the belief into questions, and answers into verified goals."""

    def __init__(
        self, belief: Belief, fields: CostFieldCfg, prompts: Prompts, draw: Draw, cfg: PlannerCfg | None = None
    ) -> None:
        self.belief, self.fields, self.prompts, self.draw = belief, fields, prompts, draw
        self.cfg = cfg or PlannerCfg()
        self.survey: Survey | None = None
        self.mode: Mode = "centroid"
        self.finished = False
        """Nothing is left that the robot could visit or explore, and that no other robot is going to."""

    def observe(self, rejections: Sequence[Rejection]) -> Question[Any] | None:
        """Make the question from the present map; None when nothing is left to choose."""
        left = self.survey = survey(self.belief, self.fields, self.cfg.forward_m, self.cfg.survey)
        reachable = [t for t in self.belief.unvisited() if math.isfinite(left.path_m(t.x, t.y))]
        self.finished = not reachable and not left.frontiers
        if self.finished:
            return None
        cfg = self.cfg
        self.mode = self._mode(left, bool(reachable))
        places = places_left(self.belief, left, self.fields, cfg.topology)
        facts = describe(self.belief, left, self._surroundings(left), cfg.verify, self._steps(left), places)
        context = {
            "facts": facts,
            "rejections": [r.reason for r in rejections],
            "step_m": cfg.step_m,
            "others": len(self.belief.others),
        }
        prompt, version = self.prompts(KIND[self.mode] if self.belief.cfg.centroids else WITHOUT_CHAIN, context)
        return Question(
            kind=KIND[self.mode],
            prompt=prompt,
            prompt_version=version,
            facts=facts,
            answer_type=CentroidChoice if self.mode == "centroid" else WaypointChoice,
            pictures=self.draw(self.belief),
        )

    def _mode(self, left: Survey, reachable: bool) -> Mode:
        """Choose the mode autonomously (paper III-C.3)."""
        if not self.cfg.centroid_selection or not reachable:
            return "waypoint"
        return "centroid" if self.belief.ahead(self.cfg.forward_m) or left.dead_end else "waypoint"

    def locate(self, question: Question[Any], answer: CentroidChoice | WaypointChoice) -> Goal | Rejection:
        """Return the point in the world that an answer means."""
        if isinstance(answer, CentroidChoice):
            track = next((t for t in self.belief.tracks if t.index == answer.selected_centroid_index), None)
            if track is None:
                labels = ", ".join(str(t.index) for t in sorted(self.belief.tracks, key=lambda t: t.index))
                return Rejection(
                    code="no-such-centroid",
                    details={"index": answer.selected_centroid_index},
                    reason=f"There is no orange dot {answer.selected_centroid_index} on the map. "
                    f"The labels on the map are: {labels or 'none'}.",
                )
            return Goal(x=track.x, y=track.y, index=track.index)
        asked_at = question.facts["robot"]
        c, s = math.cos(asked_at["theta"]), math.sin(asked_at["theta"])
        return Goal(
            x=asked_at["x"] + c * answer.forward_m - s * answer.left_m,
            y=asked_at["y"] + s * answer.forward_m + c * answer.left_m,
        )

    def verify(self, question: Question[Any], answer: CentroidChoice | WaypointChoice) -> Rejection | None:
        """Check an answer against the map as it is now, at response time (paper III-D)."""
        goal = self.locate(question, answer)
        if isinstance(goal, Rejection):
            return goal
        refusal = self._refuse(goal)
        if refusal is None:
            return None
        extra = (
            {"index": goal.index}
            if isinstance(answer, CentroidChoice)
            else {"forward_m": answer.forward_m, "left_m": answer.left_m}
        )
        return Rejection(code=refusal.code, reason=refusal.reason, details={**refusal.details, **extra})

    def _refuse(self, goal: Goal) -> Rejection | None:
        belief, cfg = self.belief, self.cfg
        if not belief.map.contains(goal.x, goal.y):
            return Rejection(code="outside", reason="The chosen point lies outside the survey area.")
        if not cfg.checks:
            return None
        left = survey(belief, self.fields, cfg.forward_m, cfg.survey)
        if not math.isfinite(left.path_m(goal.x, goal.y)):
            return Rejection(
                code="blocked",
                reason="The chosen point lies inside an obstacle, or obstacles cut it "
                "off. Choose a point in open water.",
            )
        if not separated((goal.x, goal.y), (belief.pose.x, belief.pose.y), cfg.separation_m):
            return Rejection(
                code="too-close",
                reason=f"The chosen point is within {cfg.separation_m:g} m of the "
                "robot. Choose one that makes progress.",
            )
        if belief.taken(goal.x, goal.y, goal.index):
            return Rejection(
                code="taken",
                reason="Another robot is going there already. Choose a point that no other robot is going to.",
            )
        if goal.index is not None and next(t.visited for t in belief.tracks if t.index == goal.index):
            return (
                Rejection(
                    code="visited",
                    reason=f"Orange dot {goal.index} has been visited already: the yellow "
                    "trajectory passes it. Choose one that has not.",
                )
                if cfg.verify.enabled
                else None
            )
        if not cfg.verify.enabled:
            return None
        around = self._surroundings(left)
        return verify_waypoint((goal.x, goal.y), around, cfg.verify) or self._leads_back(goal, left, around)

    def _leads_back(self, goal: Goal, left: Survey, around: Surroundings) -> Rejection | None:
        """Refuse a cluster that makes the tour of what is left much longer than another acceptable one would."""
        limit = self.cfg.topology.max_regret_m
        places = places_left(self.belief, left, self.fields, self.cfg.topology)
        chosen = next((p for p in places if p.index is not None and p.index == goal.index), None)
        if chosen is None or chosen.regret_m <= limit:
            return None
        better = [
            p
            for p in places
            if p.index is not None
            and p.regret_m < chosen.regret_m - limit
            and verify_waypoint((p.x, p.y), around, self.cfg.verify) is None
        ]
        if not better:
            return None
        best = min(better, key=lambda p: p.regret_m)
        return Rejection(
            code="loop-back",
            details={"regret_m": round(chosen.regret_m, 1), "better": best.index},
            reason=f"Orange dot {goal.index} leads back into known water: going there first makes the way past all "
            f"that is left {chosen.regret_m - best.regret_m:.0f} m longer than starting with dot {best.index}.",
        )

    def adopt(self, goal: Goal) -> bool:
        """Make a goal the active one; True if it violates Eqs. 4-8 and no exemption applies (a "deviation")."""
        left = survey(self.belief, self.fields, self.cfg.forward_m, self.cfg.survey)
        around = self._surroundings(left)
        self.belief.goal, self.belief.goal_index = (goal.x, goal.y), goal.index
        return not around.dead_end and violation((goal.x, goal.y), around, self.cfg.verify) is not None

    def _surroundings(self, left: Survey) -> Surroundings:
        """Return the inputs of the verifiers. If no remaining choice would pass, turning round is allowed."""
        belief, cfg = self.belief, self.cfg.verify
        around = Surroundings(
            pose=belief.pose,
            previous=belief.goal,
            dead_end=False,
            ahead=[(t.x, t.y) for t in belief.ahead(cfg.forward_m)],
            chain=[(t.x, t.y) for t in belief.tracks],
        )
        aims = [(t.x, t.y) for t in belief.unvisited() if math.isfinite(left.path_m(t.x, t.y))]
        if self.mode == "waypoint":
            aims += [to_world(belief.pose, o["forward_m"], o["left_m"]) for o in self._steps(left) or ()]
        open_ = any(violation(p, around, cfg) is None for p in aims if separated(p, belief.pose[:2], 1.5))
        return replace(around, dead_end=left.dead_end or not open_)

    def _steps(self, left: Survey) -> list[dict[str, float]] | None:
        """The waypoints that may be named in free waypoint mode; None in centroid selection mode."""
        if self.mode == "centroid":
            return None
        return waypoint_options(self.belief, left, self.cfg.step_m, self.cfg.separation_m)
