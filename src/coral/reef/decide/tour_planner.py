"""The planner of the full system (beyond the paper): asks ahead, offers all that is left, refuses what is provably bad.

It stands beside the paper's Algorithm 2 (`paper_planner.py`) and has the same interface. What it adds: questions are
asked ahead and measured from where the robot will be; the mode is what comes first in a tour of all that is left;
answers may name further goals, a guess, or the end of the survey; the check is `provable.py`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from coral.advisor.question import Rejection
from coral.reef.decide.answers import CentroidAnswer, CentroidChoice, WaypointChoice
from coral.reef.decide.facts import describe, waypoint_options
from coral.reef.decide.guesses import Guess, GuessRecord
from coral.reef.decide.outlook import Outlook
from coral.reef.decide.planner import Answer, AskedState, HighLevelPlanner, Mode
from coral.reef.decide.provable import contradiction, expected_at, finished_dot, hazard, leads_nowhere, too_early_to_end
from coral.reef.decide.questions import (
    KINDS,
    chosen,
    goal_of_dot,
    goal_of_step,
    make_question,
    option_points,
    outside,
    surroundings,
)
from coral.reef.decide.route import Goal, passed
from coral.reef.decide.survey import idle_water, survey
from coral.reef.decide.topology import DOT_WORTH, FAR_M2, TOLD_S, Place, RemainingTour, plan_tour, what_remains
from coral.reef.decide.trigger import separated
from coral.reef.decide.verify import verify_waypoint
from coral.reef.map.costfield import CostField
from coral.reef.map.water import Reach
from coral.reef.world.geometry import Pose, to_robot

NAMED = 3
"""Places that a question names after a refusal."""


class TourPlanner(HighLevelPlanner):
    """Asks for the next goal of a survey that visits everything."""

    guesses = GuessRecord()
    _advice: Mapping[str, Any] | None = None
    _alone = False
    """Whether the advisor has left the rest to the robot's own tour."""
    _reach: tuple[tuple[int, Pose], Reach] | None = None

    def outlook(self, way: CostField | None = None) -> Outlook:
        """Freeze what the robot knows now, and where it will be when the answer comes."""
        snapshot, route = self.belief.snapshot(), self.route
        return Outlook(
            snapshot,
            self.arrival(snapshot, way),
            under_way=bool(route.goals),
            alone=self._alone,
            latency_s=route.latency_s,
            guesses=self.guesses,
            advice=self._advice,
        )

    def ask(self, outlook: Outlook, rejections: Sequence[Rejection] = ()) -> AskedState:
        """Make the question from all that will be left."""
        asked = self._look(outlook)
        if not asked.left.frontiers and not _dots(asked) and any(t.doubtful for t in outlook.belief.tracks):
            asked = self._look(replace(outlook, last_look=True))
        outlook, left, cfg, dots = asked.outlook, asked.left, self.cfg, _dots(asked)
        if not dots and not left.frontiers:
            return replace(asked, finished=not outlook.under_way)
        if outlook.alone and not dots and asked.tour is not None:
            return replace(asked, alone=_first(asked.tour))
        mode = self._mode(asked, bool(dots))
        options = (
            waypoint_options(outlook.belief, left, outlook.arrival.pose, cfg.step_m, cfg.separation_m)
            if mode == "waypoint" or rejections
            else []
        )
        asked = replace(asked, mode=mode)
        passing = [o for o, bad in zip(options, self._lead_nowhere(asked, options), strict=True) if not bad]
        if mode == "waypoint" and not passing and outlook.under_way:
            return asked  # more of the map will be known nearer to the goal
        facts = describe(outlook, left, options if mode == "waypoint" else None) | self._told(asked, dots)
        if rejections:
            facts["passing"] = {"dots": [t.index for t in dots], "waypoints": _towards(asked, passing)}
        question = make_question(
            mode, KINDS[mode], CentroidChoice if mode == "centroid" else WaypointChoice, facts, outlook, cfg, self.draw
        )
        return replace(asked, question=question, acceptable=bool(dots if mode == "centroid" else passing))

    def _look(self, outlook: Outlook) -> AskedState:
        """Analyse the map as it will be when the answer is needed."""
        belief, cfg, arrival = outlook.belief, self.cfg, outlook.arrival
        kept, goals = arrival.path[: arrival.kept], {goal.index for goal in arrival.goals}
        dots, closed = [], set()
        for track in outlook.unvisited():
            area = FAR_M2 if track.far else len(track.left) * belief.map.cfg.cell_m**2
            if belief.cfg.inspect.enabled:
                # Only what is passed whatever is answered is taken off: beyond its kept goals the way is open.
                rest = track.left if track.far else passed(track, kept, 0.9 * belief.inspect_m)
                if track.index in goals or (
                    len(rest) * belief.map.cfg.cell_m**2 <= belief.cfg.inspect.least_m2 and (not track.far)
                ):
                    closed.add(track.index)
                    continue
            dots.append(Place(x=track.x, y=track.y, index=track.index, worth=DOT_WORTH + area))
        outlook = replace(outlook, closed=frozenset(closed), idle=idle_water(belief.map, cfg.survey))
        left = survey(outlook, self.fields, cfg.forward_m, cfg.survey)
        left = left if cfg.explore else replace(left, frontiers=())
        remaining = what_remains(outlook, left, dots, self.fields)
        tour = plan_tour(remaining, left, arrival) if cfg.topology else None
        around = surroundings(outlook, left, cfg.forward_m)
        return AskedState(
            question=None, mode="waypoint", outlook=outlook, left=left, around=around, remaining=remaining, tour=tour
        )

    def _mode(self, asked: AskedState, dots: bool) -> Mode:
        """Choose the mode by what comes first in the tour of all that is left; without a tour, by Alg. 2."""
        if not self.cfg.centroid_selection or not dots:
            return "waypoint"
        if asked.tour is not None:
            return "waypoint" if asked.tour.best.index is None else "centroid"
        return "centroid" if asked.around.ahead or asked.left.dead_end else "waypoint"

    def _told(self, asked: AskedState, dots: Sequence[Any]) -> dict[str, Any]:
        """Return what a question tells besides the map: why it is asked so, advice, and how guesses came out."""
        told: dict[str, Any] = {}
        outlook, tour = asked.outlook, asked.tour
        if asked.mode == "waypoint" and dots and tour is not None and tour.best.index is None:
            forward, left = to_robot(outlook.arrival.pose, tour.best.x, tour.best.y)
            told["first"] = {
                "forward_m": round(forward),
                "left_m": round(left),
                "dots": sorted(track.index for track in dots),
            }
        if outlook.advice is not None:
            told["advice"] = dict(outlook.advice)
        record = outlook.guesses
        if record.guesses:
            told["guesses"] = {
                "right": record.right,
                "wrong": record.wrong,
                "open": len(record.guesses) - record.right - record.wrong,
                "allowance_s": round(record.allowance_s(1.0), 1),
            }
        return told

    def verify(self, asked: AskedState, answer: Answer) -> Rejection | None:
        """Check an answer in the state in which it was asked, and for what has become impossible since."""
        if not isinstance(answer, CentroidChoice | WaypointChoice):
            kind = CentroidChoice if isinstance(answer, CentroidAnswer) else WaypointChoice
            answer = kind.model_validate(answer.model_dump())
        goal = None if answer.end_survey else self.locate(asked, answer)
        if isinstance(goal, Rejection):
            return goal
        refusal = self._refuse(asked, answer, goal)
        return None if refusal is None else replace(refusal, details={**refusal.details, **chosen(answer)})

    def _refuse(
        self, asked: AskedState, answer: CentroidChoice | WaypointChoice, goal: Goal | None
    ) -> Rejection | None:
        cfg, outlook = self.cfg, asked.outlook
        if not cfg.checks:
            return None if goal is None else outside(goal, self.belief)
        if why := contradiction(asked, answer, goal):
            return Rejection(code="contradiction", reason=f"The answer contradicts itself. {why}")
        if answer.end_survey:
            return too_early_to_end(asked)
        if _leaves_rest(answer) and (dots := _dots(asked)):
            left = ", ".join(str(track.index) for track in dots)
            return Rejection(
                code="not-done", reason=f"The rest cannot be left to the robot yet. Dots that are left: {left}."
            )
        if goal is None:
            return None
        refusal = outside(goal, self.belief) or hazard(goal, self._reach_now())
        if refusal is not None:
            return refusal
        if _leaves_rest(answer) and asked.tour is not None:
            return None
        if _dot_of(answer) is not None:
            return finished_dot(outlook, _dot_of(answer))
        if not separated((goal.x, goal.y), outlook.arrival.pose[:2], cfg.separation_m):
            return Rejection(
                code="too-close",
                reason=f"The chosen point is within {cfg.separation_m:g} m of where the robot will be. "
                "Choose one that makes progress.",
            )
        assert asked.remaining is not None
        at = np.array([goal.x]), np.array([goal.y])
        if not cfg.finished or not asked.acceptable or not leads_nowhere(outlook, asked.remaining, *at)[0]:
            return None
        return self._too_dear(asked, answer, goal)

    def _too_dear(self, asked: AskedState, answer: CentroidChoice | WaypointChoice, goal: Goal) -> Rejection | None:
        """Refuse a way back, unless a guess is stated that may cost as much."""
        why = (
            "Everything within 3 m of the chosen point is explored and done, and nothing that is left is nearer from "
            "there."
        )
        if answer.expect is None:
            return Rejection(code="finished", reason=f"{why} If you expect something there, say what in `expect`.")
        price = math.inf if asked.tour is None else asked.tour.price_s(goal.x, goal.y)
        allowed = asked.outlook.guesses.allowance_s(answer.expect.sure)
        if price <= allowed:
            return None
        cost = f"{price:.0f} s" if math.isfinite(price) else "an unknown time"
        record = asked.outlook.guesses
        return Rejection(
            code="too-dear",
            details={"allowed_s": round(allowed, 1)},
            reason=f"{why} To look there costs {cost}; {allowed:.0f} s are allowed, by how sure you are and how your "
            f"guesses came out ({record.right} right, {record.wrong} wrong).",
        )

    def locate(self, asked: AskedState, answer: Answer) -> Goal | Rejection | None:
        """Return the point in the world that an answer means."""
        if isinstance(answer, CentroidAnswer):
            step = answer.waypoint if isinstance(answer, CentroidChoice) else None
            if step is None or answer.selected_centroid_index is not None:
                return goal_of_dot(asked, answer.selected_centroid_index, self.belief)
            return goal_of_step(asked, step.forward_m, step.left_m)
        if _leaves_rest(answer) and asked.tour is not None:
            return _first(asked.tour)
        if isinstance(answer, WaypointChoice) and answer.dot is not None:
            return goal_of_dot(asked, answer.dot, self.belief)
        return goal_of_step(asked, answer.forward_m, answer.left_m)

    def onward(self, asked: AskedState, answer: Answer) -> list[Goal]:
        """Return the goals that an answer names after the first one, without those that are done or out of reach."""
        if not self.cfg.route.ahead or not isinstance(answer, CentroidChoice | WaypointChoice) or _leaves_rest(answer):
            return []
        goals: list[Goal] = []
        for step in answer.then:
            if isinstance(step, int):
                goal = goal_of_dot(asked, step, self.belief)
                track = self.belief.track(goal.index) if isinstance(goal, Goal) else None
                if track is None or track.visited or step == _dot_of(answer):
                    continue
                if finished_dot(asked.outlook, step) is not None:
                    continue
            else:
                goal = goal_of_step(asked, step.forward_m, step.left_m)
            if isinstance(goal, Goal) and goal not in goals and self.belief.map.contains(goal.x, goal.y):
                goals.append(goal)
        if not self.cfg.checks:
            return goals
        return [goal for goal in goals if hazard(goal, self._reach_now()) is None]

    def adopt(self, asked: AskedState, answer: Answer, goal: Goal) -> dict[str, Any]:
        """Note what a choice costs by the robot's own tour, and what the advisor expects there."""
        told: dict[str, Any] = {
            "violates": verify_waypoint((goal.x, goal.y), asked.around, self.cfg.verify) is not None
        }
        self._advice, self._alone = None, _leaves_rest(answer)
        tour = asked.tour
        price = 0.0 if tour is None else tour.price_s(goal.x, goal.y, goal.index)
        if tour is not None and math.isfinite(price) and price >= TOLD_S:
            told["later_s"] = round(price, 1)
            self._advice = {"chosen": chosen(answer), "later_s": round(price), "better": tour.best.index}
        expect = getattr(answer, "expect", None)
        if expect is not None:
            x, y = expected_at(asked, expect, goal)
            guess = Guess(x=round(x, 2), y=round(y, 2), what=expect.what[:200], sure=expect.sure)
            self.guesses = self.guesses.with_guess(guess, self.belief)
            told["expect"] = {"x": guess.x, "y": guess.y, "what": guess.what, "sure": guess.sure}
        return told

    def settle(self) -> list[Guess]:
        """Return the guesses that have come out since the last call."""
        self.guesses, out = self.guesses.settled(self.belief)
        return out

    def _lead_nowhere(self, asked: AskedState, options: Sequence[Mapping[str, Any]]) -> list[bool]:
        assert asked.remaining is not None
        points = option_points(asked, options)
        if not (self.cfg.checks and self.cfg.finished):
            return [False] * len(points)
        xs, ys = np.ascontiguousarray(points.T)
        return [bool(bad) for bad in leads_nowhere(asked.outlook, asked.remaining, xs, ys)]

    def _reach_now(self) -> Reach:
        """Find what can be reached on the map as it is now, from where the robot is."""
        key = (self.belief.map.version, self.belief.pose)
        if self._reach is None or self._reach[0] != key:
            self._reach = key, self.belief.water(self.fields).reach(*self.belief.pose[:2])
        return self._reach[1]


def _dots(asked: AskedState) -> list[Any]:
    """Return the clusters still to be visited that the robot can reach."""
    return [t for t in asked.outlook.unvisited() if math.isfinite(asked.left.path_m(t.x, t.y))]


def _towards(asked: AskedState, passing: Sequence[Mapping[str, Any]]) -> list[list[int]]:
    """Name a few waypoints that pass, each towards another place that is left."""
    assert asked.remaining is not None
    points = option_points(asked, passing)
    named: list[list[int]] = []
    for place in asked.remaining.places:
        if not len(points) or len(named) == NAMED:
            break
        best = passing[int(np.argmin(np.hypot(points[:, 0] - place.x, points[:, 1] - place.y)))]
        step = [int(best["forward_m"]), int(best["left_m"])]
        if step not in named:
            named.append(step)
    return named


def _dot_of(answer: CentroidChoice | WaypointChoice) -> int | None:
    return answer.selected_centroid_index if isinstance(answer, CentroidChoice) else answer.dot


def _leaves_rest(answer: Answer) -> bool:
    return isinstance(answer, WaypointChoice) and answer.explore_rest


def _first(tour: RemainingTour) -> Goal:
    """Return the place that the robot's own tour begins with."""
    return Goal(x=tour.best.x, y=tour.best.y, index=tour.best.index)
