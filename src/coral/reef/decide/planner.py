"""The high-level planner: what to ask, in which mode, and whether the answer is admissible (paper III-C, Alg. 2)."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from coral.advisor.question import Picture, Question, Rejection
from coral.config import Count
from coral.reef.decide.answers import CentroidChoice, WaypointChoice
from coral.reef.decide.facts import describe, waypoint_options
from coral.reef.decide.own_verifier import Verifier
from coral.reef.decide.route import Arrival, Goal, Route, RouteCfg, here, passed
from coral.reef.decide.survey import Survey, SurveyCfg, survey
from coral.reef.decide.topology import RemainingTour, TopologyCfg, plan_tour
from coral.reef.decide.trigger import separated
from coral.reef.decide.verify import Surroundings, VerifyCfg, stated_limits, verify_waypoint, violation
from coral.reef.map.belief import Belief
from coral.reef.map.chain import Track
from coral.reef.map.costfield import CostField, CostFieldCfg
from coral.reef.map.water import Reach
from coral.reef.world.geometry import Pose, to_robot, to_world

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
    explore: bool = True
    """False: unexplored water is no reason to go anywhere, and nothing is left when no unvisited cluster is known."""
    route: RouteCfg = field(default_factory=RouteCfg)
    survey: SurveyCfg = field(default_factory=SurveyCfg)
    verify: VerifyCfg = field(default_factory=VerifyCfg)
    topology: TopologyCfg = field(default_factory=TopologyCfg)


@dataclass(frozen=True, kw_only=True)
class AskedState:
    """The state in which a question was asked: its answer is judged in it."""

    arrival: Arrival
    left: Survey
    around: Surroundings
    tour: RemainingTour | None
    hollow: frozenset[int]
    """Labels of the dots that were not on offer."""
    strict: bool = True
    """False where no choice on offer would pass: then any is taken that can be driven to."""


class HighLevelPlanner:
    """Turns the belief into questions, and answers into verified goals."""

    def __init__(
        self,
        belief: Belief,
        fields: CostFieldCfg,
        prompts: Prompts,
        draw: Draw,
        cfg: PlannerCfg | None = None,
        route: Route | None = None,
        verifier: Verifier | None = None,
    ) -> None:
        """Set up the planner of one robot, whose goals are those of `route`; `verifier` checks what our checks pass."""
        self._verifier = verifier
        self.belief, self.fields, self.prompts, self.draw = belief, fields, prompts, draw
        self.cfg = cfg or PlannerCfg()
        self.route = route or Route(belief, self.cfg.route)
        self.asked: AskedState | None = None
        self.mode: Mode = "centroid"
        self._reach: tuple[tuple[int, Pose], Reach] | None = None
        self.finished = False
        """Nothing is left that the robot could visit or explore, and that no other robot is going to."""
        self.acceptable = 0
        """How many of the choices on offer in the last question would have passed."""

    def on(self, snapshot: Belief) -> HighLevelPlanner:
        """Return a planner of a snapshot of the belief, which may make a question on another thread."""
        other = copy.copy(self)
        other.belief, other.route = snapshot, self.route.on(snapshot)
        return other

    def take(self, other: HighLevelPlanner) -> None:
        """Take over the question that a planner of a snapshot has made: answers are judged in that state."""
        self.asked, self.mode, self.finished, self.acceptable = (
            other.asked, other.mode, other.finished, other.acceptable,
        )  # fmt: skip
        mine, theirs = self.belief, other.belief
        mine.arrival, mine.closed, mine.last_look = theirs.arrival, theirs.closed, theirs.last_look

    def observe(self, rejections: Sequence[Rejection], way: CostField | None = None) -> Question[Any] | None:
        """Make the question from the present map; None when nothing is left to choose.

        Args:
            rejections: Why the answers so far were refused.
            way: The robot's way to its present goal.
        """
        belief, cfg = self.belief, self.cfg
        belief.last_look = False
        asked = self._look(way)
        if not asked.left.frontiers and not self._dots(asked) and any(t.doubtful for t in belief.tracks):
            belief.last_look = True
            asked = self._look(way)
        self.asked, left = asked, asked.left
        reachable = self._dots(asked)
        nothing = not reachable and not left.frontiers
        self.finished = nothing and not self.route.goals
        if nothing:
            return None
        self.mode = self._mode(asked, bool(reachable))
        steps = self._steps(left, asked.arrival.pose)
        self.acceptable = self._acceptable(asked, steps)
        if not self.acceptable and self.route.goals:
            return None  # more of the map will be known nearer to the goal
        self.asked = replace(asked, strict=self.acceptable > 0)
        facts = describe(belief, left, asked.arrival, steps)
        if cfg.verify.enabled and self._by_regret(asked) is None:
            facts["limits"] = stated_limits(cfg.verify)
        context = {
            "facts": facts,
            "rejections": [r.reason for r in rejections],
            "step_m": cfg.step_m,
            "others": len(belief.others),
            "latency_s": self.route.latency_s,
            "inspect_m": belief.inspect_m,
            "verify": cfg.verify,
            "max_regret_s": cfg.topology.max_regret_s,
        }
        prompt, version = self.prompts(KIND[self.mode] if self.belief.cfg.centroids else WITHOUT_CHAIN, context)
        return Question(
            kind=KIND[self.mode],
            prompt=prompt,
            prompt_version=version,
            facts=facts,
            answer_type=CentroidChoice if self.mode == "centroid" else WaypointChoice,
            pictures=self.draw(belief),
        )

    def _look(self, way: CostField | None) -> AskedState:
        """Analyse the map as it will be when the answer is needed."""
        belief, cfg = self.belief, self.cfg
        arrival = self.route.arrival(way) if cfg.route.ahead else here(belief)
        goals = {goal.index for goal in arrival.goals}
        belief.arrival, belief.closed = arrival.pose, frozenset()
        dots = []
        for track in belief.unvisited():
            rest = len(track.left)
            if track.far and track.index not in goals:
                dots.append((track.x, track.y, track.index, cfg.topology.far_m2))
                continue
            if belief.cfg.inspect.enabled and arrival.in_s > 0.0:
                rest = 0 if track.index in goals else len(passed(track, arrival.path, 0.9 * belief.inspect_m))
            area = rest * belief.map.cfg.cell_m**2
            if belief.cfg.inspect.enabled and area <= belief.cfg.inspect.least_m2:
                belief.closed |= {track.index}
            else:
                dots.append((track.x, track.y, track.index, area))
        left = survey(belief, self.fields, cfg.forward_m, cfg.survey, arrival)
        left = left if cfg.explore else replace(left, frontiers=())
        tour = plan_tour(belief, left, arrival, dots, self.fields, cfg.topology) if cfg.topology.enabled else None
        around = Surroundings(
            pose=arrival.pose,
            previous=belief.goal,
            robot=belief.pose[:2],
            dead_end=left.dead_end,
            ahead=[(t.x, t.y) for t in belief.ahead(cfg.forward_m)],
            chain=[(t.x, t.y) for t in belief.tracks],
        )
        hollow = frozenset(t.index for t in belief.tracks if belief.done(t))
        return AskedState(arrival=arrival, left=left, around=around, tour=tour, hollow=hollow)

    def _dots(self, asked: AskedState) -> list[Track]:
        """Return the clusters still to be visited that the robot can reach."""
        return [t for t in self.belief.unvisited() if math.isfinite(asked.left.path_m(t.x, t.y))]

    def _acceptable(self, asked: AskedState, steps: Sequence[Mapping[str, float]] | None) -> int:
        """Count the choices on offer that would pass."""
        if steps is None:
            dots = self._dots(asked)
            return sum(self._objection(Goal(x=t.x, y=t.y, index=t.index), asked) is None for t in dots)
        points = np.array([to_world(asked.arrival.pose, s["forward_m"], s["left_m"]) for s in steps]).reshape(-1, 2)
        if self._by_regret(asked) is not None and len(points):
            assert asked.tour is not None
            regrets = asked.tour.regrets_at(*np.ascontiguousarray(points.T))
            return int(np.count_nonzero(regrets <= self.cfg.topology.max_regret_s))
        return sum(self._objection(Goal(x=x, y=y), asked) is None for x, y in points.tolist())

    def _by_regret(self, asked: AskedState) -> RemainingTour | None:
        """Return the tour by which choices are judged; None where they are judged by angles, or not at all."""
        return asked.tour if self.cfg.verify.by == "regret" and self.cfg.verify.enabled else None

    def _objection(self, goal: Goal, asked: AskedState) -> Rejection | None:
        """Return what speaks against a goal in the state in which it was asked for."""
        if not self.cfg.verify.enabled or not asked.strict:
            return None
        tour = self._by_regret(asked)
        if tour is not None:
            return self._regretted(goal, asked, tour)
        return verify_waypoint((goal.x, goal.y), self._exempt(asked), self.cfg.verify)

    def _mode(self, asked: AskedState, reachable: bool) -> Mode:
        """Choose the mode autonomously (paper III-C.3): by what comes first in the best tour of all that is left.

        Without a tour, by Alg. 2: dots, while one lies ahead or the robot is in a dead end.
        """
        if not self.cfg.centroid_selection or not reachable:
            return "waypoint"
        if asked.tour is not None and self.cfg.verify.by == "regret":
            return "waypoint" if asked.tour.best.index is None else "centroid"
        return "centroid" if asked.around.ahead or asked.left.dead_end else "waypoint"

    def locate(self, question: Question[Any], answer: CentroidChoice | WaypointChoice) -> Goal | Rejection:
        """Return the point in the world that an answer means."""
        if isinstance(answer, CentroidChoice):
            track = self.belief.track(answer.selected_centroid_index)
            if track is None:
                labels = ", ".join(str(t.index) for t in sorted(self.belief.tracks, key=lambda t: t.index))
                return Rejection(
                    code="no-such-centroid",
                    details={"index": answer.selected_centroid_index},
                    reason=f"There is no orange dot {answer.selected_centroid_index} on the map. "
                    f"The labels on the map are: {labels or 'none'}.",
                )
            return Goal(x=track.x, y=track.y, index=track.index)
        x, y = to_world(Pose(**question.facts["arrival"]["pose"]), answer.forward_m, answer.left_m)
        return Goal(x=x, y=y)

    def onward(self, question: Question[Any], answer: CentroidChoice | WaypointChoice) -> list[Goal]:
        """Return the goals that an answer names after the first one, without those that can be told to be wrong.

        Dots are judged like the first one, on the tour that is left by then, and end where one loses too much time.
        Waypoints are not: what they will show is not known yet.
        """
        belief = self.belief
        if not self.cfg.route.ahead:
            return []
        if isinstance(answer, CentroidChoice):
            assert self.asked is not None
            tour = self._by_regret(self.asked) if self.asked.strict else None
            labels = [index for index in answer.then if index not in self.asked.hollow]
            labels = labels if tour is None else tour.worthwhile(answer.selected_centroid_index, labels)
            tracks = [belief.track(index) for index in labels if index != answer.selected_centroid_index]
            goals = [Goal(x=t.x, y=t.y, index=t.index) for t in tracks if t is not None and not t.visited]
        else:
            pose = Pose(**question.facts["arrival"]["pose"])
            goals = [Goal(x=x, y=y) for x, y in (to_world(pose, s.forward_m, s.left_m) for s in answer.then)]
        goals = [goal for goal in goals if belief.map.contains(goal.x, goal.y)]
        return [goal for goal in goals if self._obstacle_to(goal) is None] if self.cfg.checks else goals

    def verify(self, question: Question[Any], answer: CentroidChoice | WaypointChoice) -> Rejection | None:
        """Check an answer in the state in which it was asked, and for what has become impossible since (III-D)."""
        goal = self.locate(question, answer)
        if isinstance(goal, Rejection):
            # A dot that has merged into another since was right when it was asked for.
            offered = {c["index"] for c in question.facts["centroids"]}
            return None if goal.details["index"] in offered else goal
        refusal = self._refuse(goal)
        if refusal is None and self._verifier is not None:
            refusal = self._verifier(question, answer)
        if refusal is None:
            return None
        extra = (
            {"index": goal.index}
            if isinstance(answer, CentroidChoice)
            else {"forward_m": answer.forward_m, "left_m": answer.left_m}
        )
        return Rejection(code=refusal.code, reason=refusal.reason, details={**refusal.details, **extra})

    def _refuse(self, goal: Goal) -> Rejection | None:
        belief, cfg, asked = self.belief, self.cfg, self.asked
        assert asked is not None
        if not belief.map.contains(goal.x, goal.y):
            return Rejection(code="outside", reason="The chosen point lies outside the survey area.")
        if not cfg.checks:
            return None
        refusal = self._obstacle_to(goal)
        if refusal is not None:
            return refusal
        if goal.index is None and not separated((goal.x, goal.y), asked.arrival.pose[:2], cfg.separation_m):
            return Rejection(
                code="too-close",
                reason=f"The chosen point is within {cfg.separation_m:g} m of where the robot will be. "
                "Choose one that makes progress.",
            )
        if goal.index in asked.hollow:
            return Rejection(
                code="visited",
                reason=f"Orange dot {goal.index} is hollow: it has been seen from near, or will have been on the way. "
                f"Choose a solid one{self._passing()}.",
            )
        return self._objection(goal, asked)

    def _obstacle_to(self, goal: Goal) -> Rejection | None:
        """Return what stands in the way of a goal on the map as it is now: obstacles, or another robot."""
        if not self._reach_now().reaches(goal.x, goal.y):
            return Rejection(
                code="blocked",
                reason="The chosen point lies inside an obstacle, or obstacles cut it "
                "off. Choose a point in open water.",
            )
        if self.belief.taken(goal.x, goal.y, goal.index):
            return Rejection(
                code="taken",
                reason="Another robot is going there already. Choose a point that no other robot is going to.",
            )
        return None

    def _reach_now(self) -> Reach:
        """Find what can be reached on the map as it is now, from where the robot is."""
        belief = self.belief
        key = (belief.map.version, belief.pose)
        if self._reach is None or self._reach[0] != key:
            self._reach = key, belief.water(self.fields).reach(*belief.pose[:2])
        return self._reach[1]

    def _regretted(self, goal: Goal, asked: AskedState, tour: RemainingTour) -> Rejection | None:
        """Refuse a choice that delays what is left by much more than the best one does."""
        cfg, best = self.cfg.topology, tour.best
        regret = None if goal.index is None else tour.regret_of(goal.index)
        if regret is None:
            regret = float(tour.regrets_at(np.array([goal.x]), np.array([goal.y]))[0])
        if regret <= cfg.max_regret_s:
            return None
        forward, left = to_robot(asked.arrival.pose, best.x, best.y)
        better = f"dot {best.index}" if best.index is not None else f"going {forward:.0f} m forward, {left:+.0f} m left"
        return Rejection(
            code="regret",
            details={"regret_s": round(regret, 1), "better": best.index},
            reason=f"Going there first delays all that is left to see by {regret:.0f} s on average, against {better} "
            f"first; at most {cfg.max_regret_s:.0f} s is accepted{self._passing()}.",
        )

    def _passing(self) -> str:
        """Name the dots that would pass, for a refusal."""
        tour = None if self.asked is None else self.asked.tour
        if tour is None or self.mode != "centroid":
            return ""
        limit = self.cfg.topology.max_regret_s
        left = {track.index for track in self.belief.unvisited()}  # some may have been seen since
        good = sorted(p.index for p in tour.places if p.index in left and p.regret_s <= limit)
        return f". These would pass: {', '.join(map(str, good))}" if good else ""

    def adopt(self, goal: Goal) -> bool:
        """Return whether a goal violates Eqs. 4-8 without an exemption (a "deviation"), as it was asked for."""
        assert self.asked is not None
        around = self._exempt(self.asked)
        return not around.dead_end and violation((goal.x, goal.y), around, self.cfg.verify) is not None

    def _exempt(self, asked: AskedState) -> Surroundings:
        """Return the inputs of the verifiers. If no remaining choice would pass, turning round is allowed."""
        cfg, around = self.cfg.verify, asked.around
        aims = [(t.x, t.y) for t in self._dots(asked)]
        if self.mode == "waypoint":
            steps = self._steps(asked.left, around.pose) or ()
            aims += [to_world(around.pose, o["forward_m"], o["left_m"]) for o in steps]
        open_ = any(violation(p, around, cfg) is None for p in aims if separated(p, around.pose[:2], 1.5))
        return replace(around, dead_end=around.dead_end or not open_)

    def _steps(self, left: Survey, pose: Pose) -> list[dict[str, float]] | None:
        """The waypoints that may be named in free waypoint mode; None in centroid selection mode."""
        if self.mode == "centroid":
            return None
        return waypoint_options(self.belief, left, pose, self.cfg.step_m, self.cfg.separation_m)
