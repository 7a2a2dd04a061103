"""The planner of a mission in words: every question tells the instruction, and what was found and ruled out.

It offers every place that can be reached and refuses only what is unsafe, out of reach or contradicts itself: what the
instruction means is for the advisor to say. What was said of a cluster stays with its place.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

from coral.advisor.question import Rejection
from coral.reef.decide.answers import LookFrom, MissionAnswer
from coral.reef.decide.facts import describe, waypoint_options
from coral.reef.decide.outlook import Outlook
from coral.reef.decide.planner import Answer, AskedState, HighLevelPlanner
from coral.reef.decide.provable import finished_dot, hazard
from coral.reef.decide.questions import goal_of_dot, goal_of_step, make_question, outside, surroundings
from coral.reef.decide.route import Goal
from coral.reef.decide.said import WHY_CHARACTERS, Said, of_place, records_of, with_said
from coral.reef.decide.survey import survey
from coral.reef.decide.trigger import separated
from coral.reef.map.belief import Belief
from coral.reef.map.costfield import CostField
from coral.reef.world.geometry import Pose, to_robot

RING_M, STEP_RAD, RING_PASS_M, STOP_M = 2.0, math.radians(45.0), 0.8, 0.25
"""The way round something keeps this much farther from it than the look, and turns by so much from goal to goal, each
of which is passed so near: whoever cuts the ring short arrives with the thing abeam, out of the picture. So near to the
last goal the robot turns to the thing, asks, and waits for the answer."""


class MissionPlanner(HighLevelPlanner):
    """Asks for the next step of a mission in words."""

    said: tuple[Said, ...] = ()

    def instruct(self, words: str) -> None:
        """Follow other words. What was ruled out was so under the old ones, and is open again."""
        self.cfg = replace(self.cfg, instruction=replace(self.cfg.instruction, text=words))
        self._keep(replace(one, skip=False) for one in self.said if one.label)

    def _keep(self, said: Iterable[Said]) -> None:
        self.said = tuple(said)
        self.route.ruled_out = tuple((one.x, one.y) for one in self.said if one.skip)

    def outlook(self, way: CostField | None = None) -> Outlook:
        """Freeze what the robot knows now, and where it will be when the answer comes."""
        snapshot, route = self.belief.snapshot(), self.route
        arrival = self.arrival(snapshot, way)
        goals = {goal.index for goal in arrival.goals if goal.index is not None}
        return Outlook(
            snapshot,
            arrival,
            closed=frozenset(goals | self._ruled_out(snapshot)),
            last_look=True,
            colours=True,
            under_way=bool(route.goals),
            latency_s=route.latency_s,
        )

    def _ruled_out(self, belief: Belief) -> set[int]:
        return {t.index for t in belief.tracks if (s := of_place(self.said, t.x, t.y)) is not None and s.skip}

    def ask(self, outlook: Outlook, rejections: Sequence[Rejection] = ()) -> AskedState:
        """Make the question: there always is one, for only the advisor knows when the mission is done."""
        cfg, belief, pose = self.cfg, outlook.belief, outlook.arrival.pose
        left = survey(outlook, self.fields, cfg.forward_m, cfg.survey)
        options = waypoint_options(belief, left, pose, cfg.step_m, cfg.separation_m)
        facts = describe(outlook, left, options) | {"mission": self._told(outlook)}
        question = make_question("mission", "reef-mission", MissionAnswer, facts, outlook, cfg, self.draw)
        around = surroundings(outlook, left, cfg.forward_m)
        return AskedState(question=question, mode="mission", outlook=outlook, left=left, around=around)

    def _told(self, outlook: Outlook) -> dict[str, Any]:
        """Return what a question tells of the mission."""
        belief, pose = outlook.belief, outlook.arrival.pose
        forward, left = to_robot(pose, *belief.trajectory[0])
        said = [(track.index, one) for track in belief.tracks if (one := of_place(self.said, track.x, track.y))]
        dotless = [one for one in self.said if all(one is not of_dot for _, of_dot in said)]
        return {
            "instruction": self.cfg.instruction.text,
            "time_s": self.cfg.instruction.time_s,
            "at_s": round(self.route.t + outlook.arrival.in_s, 1),
            "home": {"forward_m": round(float(forward), 1), "left_m": round(float(left), 1)},
            "area_m": [round(edge, 1) for edge in belief.map.size_m],
            "place": {"east_m": round(pose.x, 1), "north_m": round(pose.y, 1)},
            "heading_deg": round(math.degrees(pose.theta)) % 360,
            "found": [{"dot": index, "label": one.label} for index, one in said if one.label],
            "ruled_out": [index for index, one in said if one.skip],
            "without_dot": [self._placed(one, pose) for one in dotless],
            "pictures": [
                {"dot": track.index, "distance_m": round(view.distance_m, 1), "age_s": round(age_s)}
                for track, view, age_s in belief.best_views.of(belief.tracks)
            ],
        }

    def _placed(self, one: Said, pose: Pose) -> dict[str, Any]:
        forward, left = to_robot(pose, one.x, one.y)
        return {"forward_m": round(float(forward), 1), "left_m": round(float(left), 1), "name": one.name}

    def verify(self, asked: AskedState, answer: Answer) -> Rejection | None:
        """Check an answer for what is unsafe or impossible."""
        assert isinstance(answer, MissionAnswer)
        named = {
            "selected_centroid_index": answer.selected_centroid_index is not None,
            "waypoint": answer.waypoint is not None,
            "look": answer.look is not None,
            "home": answer.home,
            "done": answer.done,
        }
        given = [name for name, there in named.items() if there]
        if len(given) != 1:
            return Rejection(
                code="contradiction",
                details={"index": answer.selected_centroid_index},
                reason=f"Give one of {', '.join(named)}; the answer gives {' and '.join(given) or 'none of them'}.",
            )
        goals = self._goals(asked, answer)
        if isinstance(goals, Rejection):
            return goals
        if answer.selected_centroid_index is not None and goals:
            index = answer.selected_centroid_index
            done = finished_dot(asked.outlook, index)
            track = asked.outlook.belief.track(index)
            open_again = track is not None and not track.visited and index in self._ruled_out(asked.outlook.belief)
            if done is not None and not open_again:
                return replace(done, details={"index": index})
        elif answer.waypoint is not None and goals:
            at = asked.outlook.arrival.pose[:2]
            if not separated((goals[0].x, goals[0].y), at, self.cfg.separation_m):
                reason = f"The waypoint is within {self.cfg.separation_m:g} m of where the robot will be."
                return Rejection(code="too-close", reason=reason)
        reach = self.belief.water(self.fields).reach(*self.belief.pose[:2])
        for goal in goals[-1:]:
            if refusal := outside(goal, self.belief) or hazard(goal, reach):
                return replace(refusal, details={**refusal.details, "index": answer.selected_centroid_index})
        return None

    def _goals(self, asked: AskedState, answer: MissionAnswer) -> list[Goal] | Rejection:
        """Return the places that an answer leads to, in order."""
        if answer.home:
            x, y = self.belief.trajectory[0]
            return [Goal(x=float(x), y=float(y))]
        if answer.waypoint is not None:
            return [goal_of_step(asked, answer.waypoint.forward_m, answer.waypoint.left_m)]
        if answer.done:
            return []
        index = answer.look.dot if answer.look is not None else answer.selected_centroid_index
        goal = goal_of_dot(asked, index, self.belief)
        if isinstance(goal, Rejection):
            return goal
        if goal is None:  # the map no longer shows it, and it stands where it stood
            (thing,) = (track for track in asked.outlook.belief.tracks if track.index == index)
            goal = Goal(x=thing.x, y=thing.y)
        if answer.look is None:
            return [goal]
        goals = way_round(answer.look, (goal.x, goal.y), asked.outlook.arrival.pose[:2])
        reach = self.belief.water(self.fields).reach(*self.belief.pose[:2])
        there = [g for g in goals if self.belief.map.contains(g.x, g.y) and reach.reaches(g.x, g.y)]
        if there[-2:] != goals[-2:]:  # nor room to turn towards it
            reason = "There is no way to that side of it. Choose another side or another distance."
            return Rejection(code="blocked", reason=reason)
        return there

    def locate(self, asked: AskedState, answer: Answer) -> Goal | Rejection | None:
        """Return the first place that an answer leads to."""
        assert isinstance(answer, MissionAnswer)
        goals = self._goals(asked, answer)
        return goals if isinstance(goals, Rejection) else next(iter(goals), None)

    def onward(self, asked: AskedState, answer: Answer) -> list[Goal]:
        """Return the goals after the first one: the way round what is looked at, or the dots that are named."""
        assert isinstance(answer, MissionAnswer)
        goals = self._goals(asked, answer)
        if isinstance(goals, Rejection) or answer.home or answer.look is not None:
            return [] if isinstance(goals, Rejection) else goals[1:]
        more = [goal_of_dot(asked, index, self.belief) for index in answer.then]
        open_ = [g for g in more if isinstance(g, Goal) and finished_dot(asked.outlook, g.index) is None]
        return [goal for goal in open_ if goal not in goals]

    def adopt(self, asked: AskedState, answer: Answer, goal: Goal) -> dict[str, Any]:
        """Keep what the advisor said of clusters, and return all that it has said."""
        assert isinstance(answer, MissionAnswer)
        known = {track.index: track for track in asked.outlook.belief.tracks}
        labels = {mark.dot: mark.label for mark in answer.marks}
        why = answer.reason[:WHY_CHARACTERS]
        for index in (*labels, *(dot for dot in answer.skip if dot not in labels)):
            if (track := known.get(index)) is not None:
                skip = index in answer.skip
                new = Said(dot=index, x=track.x, y=track.y, label=labels.get(index, ""), skip=skip, why=why)
                self._keep(with_said(self.said, new))
        chosen = [
            known[k] for k in (answer.selected_centroid_index, *answer.then) if k in known and k not in answer.skip
        ]
        reopened = [of_place(self.said, track.x, track.y) for track in chosen]
        self._keep(replace(one, skip=False) if any(one is other for other in reopened) else one for one in self.said)
        told = {"look": answer.look.side} if answer.look is not None else {}
        return {"violates": False, **told, **({"said": records_of(self.said)} if self.said else {})}


def way_round(look: LookFrom, thing: tuple[float, float], robot: tuple[float, float]) -> list[Goal]:
    """Return goals that lead round a thing to the side of a look, the last one at its distance, facing the thing.

    Whoever is nearer already stays where it is.
    """
    begin = math.atan2(robot[1] - thing[1], robot[0] - thing[0])
    turn = {"near": 0.0, "left": -0.5 * math.pi, "right": 0.5 * math.pi, "far": math.pi}[look.side]
    steps = round(abs(turn) / STEP_RAD)
    ring = [(begin + turn * (k + 1) / steps, look.distance_m + RING_M, RING_PASS_M) for k in range(steps)]
    stop_m = look.distance_m if steps else min(look.distance_m, math.dist(robot, thing))
    last = (begin + turn, stop_m, STOP_M)
    goals = [
        Goal(x=thing[0] + r * math.cos(a), y=thing[1] + r * math.sin(a), pass_m=near) for a, r, near in (*ring, last)
    ]
    return [*goals[:-1], replace(goals[-1], face=thing)]
