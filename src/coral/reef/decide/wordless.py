"""Rules for missions in words that do not see what things are: reference rows, and the fallback of an advisor.

They go to the nearest dot until they have seen as many as they were told, or all there is, and come home in time.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from coral.advisor.question import Rejection
from coral.reef.decide.answers import LookFrom, MissionAnswer, WaypointStep
from coral.reef.world.instruction import Answered, Clause, DoneBy, EndsAt, InOrder, Inspected, KeptOff, Sides, spoken

SPEED_M_S, MARGIN_S = 0.4, 12.0
"""Expected on the way home, and time kept for it."""
Fact = Mapping[str, Any]
Side = Literal["near", "left", "right", "far"]


@dataclass(frozen=True, kw_only=True)
class BlindOrders:
    """What rules without eyes can make of a mission."""

    count: int | None = None
    """Dots to go to; None: all."""
    sides: int = 1
    """From how many sides."""
    off_m: float = 0.0
    """How far to keep from each."""
    home: bool = False
    time_s: float | None = None
    """When to be done; None: the mission's limit."""
    answers: tuple[str, ...] = ()
    """Answers to choose from; numbers: the number of dots found is said."""
    counts: bool = False

    @classmethod
    def of_conditions(cls, conditions: Collection[Clause], kinds: Mapping[str, str]) -> BlindOrders:
        """Return what the conditions tell without the kinds: numbers, distances, times.

        Of `kinds`, by name of the thing, only how many there are of those that a condition names is read.
        """
        orders: dict[str, Any] = {}
        for one in conditions:
            match one:
                case Inspected():
                    named = sum(kind in one.of or name in one.of for name, kind in kinds.items())
                    orders["count"] = one.count or math.ceil(one.share * named - 1e-9)
                case InOrder():
                    orders["count"] = len(one.of)
                case Sides():
                    orders |= {"sides": one.count, "count": 1}
                case KeptOff():
                    orders["off_m"] = one.distance_m
                case EndsAt():
                    orders["home"] = one.at == "start"
                    orders.setdefault("count", None if one.at == "start" else 1)
                case DoneBy():
                    orders["time_s"] = one.time_s
                case Answered():
                    orders |= {
                        "answers": tuple(sorted({*one.right, *one.wrong})),
                        "counts": all(w.isdigit() for w in one.right),
                    }
        return cls(**orders)

    @classmethod
    def of_words(cls, instruction: str) -> BlindOrders:
        """Return what key words of an instruction tell: the sceptic's reading."""
        text = " ".join(spoken(instruction))
        time = re.search(r"(\d+) (?:s|seconds)\b", text)
        off = re.search(r"(\d+) (?:m|met(?:re|er)s?)\b", text)
        sides = re.search(r"(\d+) (?:sides|directions)", text)
        every = re.search(r"\b(?:every|all|each|only)\b", text)
        counts = "how many" in text or "count" in text
        one = re.search(r"\b(?:find|stop|which)\b", text)
        return cls(
            count=None if every or counts or not one else 1,
            sides=int(sides[1]) if sides else 1,
            off_m=float(off[1]) if (off and "away" in text) or (off and "off" in text) else 0.0,
            home=bool(re.search(r"\b(?:home|back|return|start)\b", text)),
            time_s=float(time[1]) if time else None,
            answers=("north", "south", "east", "west") if "which" in text else (),
            counts=counts,
        )


def late(told: Fact, limit_s: float, home: bool) -> bool:
    """Whether it is time to end, and before that to drive home."""
    way_s = math.hypot(told["home"]["forward_m"], told["home"]["left_m"]) / SPEED_M_S if home else 0.0
    return bool(told["at_s"] + way_s + MARGIN_S >= limit_s)


def step_towards(facts: Fact, at: tuple[float, float], why: str, tries: int) -> MissionAnswer:
    """Go by the waypoint nearest to a place (m forward, m left), after so many refusals by the next best one."""
    ordered = sorted(facts["options"], key=lambda step: math.dist((step["forward_m"], step["left_m"]), at))
    if not ordered:
        return MissionAnswer(home=True, reason="no way on")
    best = ordered[min(tries, len(ordered) - 1)]
    return MissionAnswer(waypoint=WaypointStep(forward_m=best["forward_m"], left_m=best["left_m"]), reason=why)


class Wordless:
    """Answers the questions of one mission by orders alone."""

    def __init__(self, orders: BlindOrders | None = None) -> None:
        self.orders = orders or BlindOrders()
        self._turned = 0

    def __call__(self, facts: Fact, rejections: Sequence[Rejection]) -> MissionAnswer:
        """Return the next step."""
        orders, told = self.orders, facts["mission"]
        refused = {rejection.details.get("index") for rejection in rejections}
        home_m = math.hypot(told["home"]["forward_m"], told["home"]["left_m"])
        limit_s = min(filter(None, (orders.time_s, told["time_s"])), default=math.inf)
        visited = sum(dot["visited"] for dot in facts["centroids"])
        open_ = [
            dot
            for dot in facts["centroids"]
            if not dot["visited"] and dot["path_m"] is not None and dot["index"] not in refused
        ]
        enough = orders.count is not None and visited >= orders.count and orders.sides == 1
        if enough or late(told, limit_s, orders.home):
            return self._end(facts, home_m)
        if open_ or (orders.sides > 1 and facts["centroids"]):
            return self._towards(facts, open_ or list(facts["centroids"]), home_m)
        fronts = [f for f in facts["frontiers"] if f["path_m"] is not None]
        if not fronts or len(rejections) > 3:
            return self._end(facts, home_m)
        front = min(fronts, key=lambda f: f["path_m"])
        at = front["forward_m"], front["left_m"]
        return step_towards(facts, at, "towards unexplored water", len(rejections))

    def _towards(self, facts: Fact, dots: Sequence[Fact], home_m: float) -> MissionAnswer:
        orders = self.orders
        near = min(dots, key=lambda dot: dot["path_m"] or math.inf)
        if orders.sides == 1 and orders.off_m == 0.0:
            return MissionAnswer(selected_centroid_index=near["index"], reason="the nearest dot")
        if self._turned >= orders.sides:
            return self._end(facts, home_m)
        self._turned += 1
        side: Side = "near" if self._turned == 1 else "right"
        look = LookFrom(dot=near["index"], side=side, distance_m=min(max(orders.off_m + 1.2, 1.5), 6.0))
        return MissionAnswer(look=look, reason="the nearest dot, from another side")

    def _end(self, facts: Fact, home_m: float) -> MissionAnswer:
        if self.orders.home and home_m > 2.0:
            return MissionAnswer(home=True, reason="it is time to go back")
        found = str(len(facts["centroids"]))
        said = found if self.orders.counts else next(iter(self.orders.answers), "")
        return MissionAnswer(done=True, answer=said, reason="no more to do")
