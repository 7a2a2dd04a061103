"""A perfect reader: the control of a mission in words, no decision of a robot.

It is told the conditions and, in truth, what a thing is, but only of what has been seen from near enough to tell. What
it does not fulfil, no reader of the pictures can be asked to.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Any

from coral.advisor.question import Rejection
from coral.reef.decide.answers import LookFrom, MissionAnswer
from coral.reef.decide.wordless import Side, late, step_towards
from coral.reef.world.geometry import Pose, to_robot, to_world
from coral.reef.world.instruction import Answered, DoneBy, EndsAt, InOrder, Inspected, Sides, apart
from coral.reef.world.kinds import find_kind
from coral.reef.world.world import ReefWorld
from coral.reef.world.world_model import Thing

READ_M, READ_SHARE, READ_RAD = 5.0, 0.6, math.radians(50.0)
"""What a thing is can be told from so far, or so much of the visibility, within so much of the camera's axis."""
SAME_M = 1.5
"""A dot this near to a thing is of it."""
LOOK_M, SURE_M = 3.4, 0.3
"""Something unknown is looked at from so far, or from so much nearer than it can be told."""
NEARER_M, NEAREST_M = 0.4, 2.2
"""A look that told nothing is repeated from so much nearer."""
JOINED_M = 2.3
"""Pieces of a cable this near to each other are one: who sees the end of one sees where it goes on."""
SIDE_M = 4.0
TURNS: Mapping[Side, float] = {"near": 0.0, "right": 0.5 * math.pi, "left": -0.5 * math.pi}
"""Sides to look from next, at `SIDE_M`, and how far round (rad) they are."""
ROUND_RAD = tuple(math.radians(turn) for turn in (65.0, -65.0, 90.0, -90.0, 120.0, -120.0, 180.0))
"""Where there is no way to such a side, the robot goes so far round first."""

Fact = Mapping[str, Any]
Point = tuple[float, float]


class WordReader:
    """Answers the questions of one mission as someone who sees kinds and understands the words."""

    def __init__(self, world: ReefWorld, visibility_m: float | None = None) -> None:
        assert world.mission is not None
        self._read_m = READ_M if visibility_m is None else min(READ_M, READ_SHARE * visibility_m)
        self._things = {thing.name: thing for thing in world.things if not find_kind(thing.kind).circles}
        self._size_m = world.size_m
        self._conditions = world.mission.conditions
        self._known: set[str] = set()
        self._reached: set[str] = set()
        self._sides: list[float] = []
        """Directions (rad) from which the thing was looked at that is to be seen from several sides."""
        self._turning = ""
        """Name of that thing, when the last answer was a look at it."""
        self._looked: tuple[Point, ...] = ()

    def __call__(self, facts: Fact, rejections: Sequence[Rejection]) -> MissionAnswer:
        """Return the next step."""
        pose, told = Pose(**facts["arrival"]["pose"]), facts["mission"]
        self._see(facts, pose)
        if self._turning and not rejections:
            self._sides.append(_bearing(pose, _at(self._things[self._turning])))
            self._turning = ""
        if len(rejections) > 3 or self._late(told) or (self._enough() and not rejections):
            return self._end(facts, rejections)
        refused = {rejection.details.get("index") for rejection in rejections} - {None}
        open_ = [d for d in facts["centroids"] if d["path_m"] is not None and d["index"] not in refused]
        thing_of = {dot["index"]: self._thing(_place(pose, dot)) for dot in open_}
        ahead = self._ahead(pose)
        for one in self._conditions:
            if isinstance(one, Sides) and (nets := [d for d in open_ if thing_of[d["index"]] in self._of(one.of)]):
                return self._turn(facts, pose, nets[0]["index"], thing_of[nets[0]["index"]], rejections)
        if ahead:
            goal = self._things[ahead[0]]
            at = to_robot(pose, goal.x, goal.y)
            dots = [d["index"] for d in open_ if thing_of[d["index"]] == goal.name and not d["visited"]]
            if dots:
                return MissionAnswer(selected_centroid_index=dots[0], reason=f"a {goal.kind}")
            return self._towards(facts, at, f"to a {goal.kind}", rejections)
        unknown = [d for d in open_ if thing_of[d["index"]] not in self._known and not self._read(facts, d)]
        if unknown:
            # What was looked at is in the pictures only when the robot has come there: something else in between.
            looks = {d["index"]: sum(math.dist(_place(pose, d), at) <= SAME_M for at in self._looked) for d in unknown}
            dot = min(unknown, key=lambda d: (looks[d["index"]], d["path_m"]))
            nearer_m = NEARER_M * looks[dot["index"]]
            look = LookFrom(
                dot=dot["index"], side="near", distance_m=max(min(LOOK_M, self._read_m - SURE_M) - nearer_m, NEAREST_M)
            )
            self._looked = (*self._looked, _place(pose, dot))
            return MissionAnswer(look=look, reason="what is it?")
        fronts = [f for f in facts["frontiers"] if f["path_m"] is not None]
        if not fronts:
            return self._end(facts, rejections)
        front = min(fronts, key=lambda f: f["path_m"])
        return self._towards(facts, (front["forward_m"], front["left_m"]), "towards unexplored water", rejections)

    def _turn(self, facts: Fact, pose: Pose, dot: int, name: str, rejections: Sequence[Rejection]) -> MissionAnswer:
        """Look at a dot from a side that was not seen yet, or go towards one."""
        x, y = _at(self._things[name])
        now = _bearing(pose, (x, y))

        def new(turn: float) -> bool:
            return apart([*self._sides, now + turn]) > apart(self._sides)

        sides = [side for side, turn in TURNS.items() if new(turn)]
        self._turning = name if len(rejections) < len(sides) else ""
        if self._turning:
            look = LookFrom(dot=dot, side=sides[len(rejections)], distance_m=SIDE_M)
            return MissionAnswer(look=look, reason="a new side of it")
        ways = [now + turn for turn in ROUND_RAD if new(turn)]
        places = [(x + SIDE_M * math.cos(a), y + SIDE_M * math.sin(a)) for a in ways]
        free = [one for one in places if all(1.0 < v < most - 1.0 for v, most in zip(one, self._size_m, strict=True))]
        at = to_robot(pose, *(free or [(x, y)])[0])
        return self._towards(facts, at, "round to a new side of it", rejections[len(sides) :])

    def _of(self, of: Collection[str]) -> list[str]:
        return [name for name, thing in self._things.items() if thing.kind in of or name in of]

    def _thing(self, at: Point) -> str:
        """Return the name of the thing that a dot at a place is of, "" for none."""
        name, thing = min(self._things.items(), key=lambda item: math.dist(at, _at(item[1])))
        return name if math.dist(at, _at(thing)) <= SAME_M else ""

    def _see(self, facts: Fact, pose: Pose) -> None:
        """Take in what the question's pictures show from near enough, and what has been visited."""
        dots = {dot["index"]: dot for dot in facts["centroids"]}
        near = [shot["dot"] for shot in facts["mission"]["pictures"] if shot["distance_m"] <= self._read_m]
        self._known |= {self._thing(_place(pose, dots[index])) for index in near if index in dots} - {""}
        now = Pose(**facts["robot"])
        ends = [_at(self._things[name]) for name in self._known if self._lies(name)]
        for name, thing in self._things.items():
            if self._lies(name) and any(math.dist(_at(thing), end) <= JOINED_M for end in ends):
                self._known.add(name)
            forward, left = to_robot(now, *_at(thing))
            if math.hypot(forward, left) <= self._read_m and abs(math.atan2(left, forward)) <= READ_RAD:
                self._known.add(name)
            if self._lies(name) and math.dist(_at(thing), pose[:2]) <= SAME_M:
                self._reached.add(name)
        self._reached |= {self._thing(_place(pose, dot)) for dot in dots.values() if dot["visited"]} & self._known
        last = self._of([one.at for one in self._conditions if isinstance(one, EndsAt)])
        self._reached -= {name for name in last if math.dist(_at(self._things[name]), pose[:2]) > SAME_M}

    def _lies(self, name: str) -> bool:
        """Tell whether a thing lies flat: no dot is of it."""
        return find_kind(self._things[name].kind).class_ == "floor"

    def _read(self, facts: Fact, dot: Fact) -> bool:
        """Tell whether a dot has been seen from near: it is of nothing then."""
        shots = facts["mission"]["pictures"]
        return any(shot["dot"] == dot["index"] and shot["distance_m"] <= self._read_m for shot in shots)

    def _ahead(self, pose: Pose) -> list[str]:
        """Return the known things to go to, the next one first."""
        for one in self._conditions:
            if isinstance(one, InOrder):
                left = [kind for kind in one.of if not set(self._of((kind,))) <= self._reached][:1]
                return [name for name in self._of(left) if name in self._known]
        names = [name for one in self._conditions if isinstance(one, Inspected) for name in self._of(one.of)]
        left = sorted(
            (name for name in names if name in self._known - self._reached),
            key=lambda name: math.dist(_at(self._things[name]), pose[:2]),
        )
        ends = [one.at for one in self._conditions if isinstance(one, EndsAt) and one.at != "start"]
        return left or [name for name in self._of(ends) if name in self._known - self._reached]

    def _enough(self) -> bool:
        """Tell whether there is no more to find; without a number in the words there may always be more."""
        for one in self._conditions:
            match one:
                case Inspected():
                    need = one.count or (len(one.of) if set(one.of) <= set(self._things) else None)
                    if need is not None and len(self._reached & set(self._of(one.of))) < need:
                        return False
                    if need is None and not any(
                        isinstance(end, EndsAt) and end.at != "start" for end in self._conditions
                    ):
                        return False
                case InOrder():
                    if not set(self._of(one.of)) <= self._reached:
                        return False
                case Sides() if apart(self._sides) < one.count:
                    return False
                case EndsAt() if one.at != "start" and not set(self._of((one.at,))) <= self._reached:
                    return False
                case _:
                    pass
        return True

    def _late(self, told: Fact) -> bool:
        limits = [one.time_s for one in self._conditions if isinstance(one, DoneBy)]
        home = any(isinstance(one, EndsAt) and one.at == "start" for one in self._conditions)
        return late(told, min([*limits, told["time_s"] or math.inf]), home)

    def _end(self, facts: Fact, rejections: Sequence[Rejection]) -> MissionAnswer:
        home = facts["mission"]["home"]["forward_m"], facts["mission"]["home"]["left_m"]
        if any(isinstance(one, EndsAt) and one.at == "start" for one in self._conditions) and math.hypot(*home) > 2.0:
            return MissionAnswer(home=True, reason="back to the start")
        answer = ""
        for one in self._conditions:
            if isinstance(one, Answered):
                right = one.right[0]
                counted = [n for c in self._conditions if isinstance(c, Inspected) for n in self._of(c.of)]
                found = str(len(set(counted) & self._known))
                answer = found if right.isdigit() else right if right in self._known else ""
        return MissionAnswer(done=True, answer=answer, reason="that is all")

    def _towards(self, facts: Fact, at: Point, why: str, rejections: Sequence[Rejection]) -> MissionAnswer:
        """Go by a waypoint towards a place (m forward, m left)."""
        return step_towards(facts, at, why, len(rejections), way_share=0.6)


def _place(pose: Pose, dot: Fact) -> Point:
    return to_world(pose, dot["forward_m"], dot["left_m"])


def _bearing(pose: Pose, of: Point) -> float:
    """Return the direction (rad) of a pose as seen from a place."""
    return math.atan2(pose.y - of[1], pose.x - of[0])


def _at(thing: Thing) -> Point:
    return thing.x, thing.y
