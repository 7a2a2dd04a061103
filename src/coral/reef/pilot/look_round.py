"""Turns on the spot: to look, where only doubtful obstacles fence the vehicle in, and against twists of the tether."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal

from coral.reef.map.belief import Belief
from coral.reef.world.geometry import Pose, wrap

Step = Literal["turn", "forget"]


YAW_RATE_RAD_S = 0.5
"""Rate of the turn; a picture at 10 Hz is then 3° from the one before."""
APART_M = 1.0
"""A place this far from the last one is worth another turn."""
MOST_TURNS = 5
"""In a mission."""


class LookRound:
    """Takes one step after another: a turn on the spot; then doubtful obstacles are forgotten until seen again."""

    def __init__(self, belief: Belief) -> None:
        self.belief = belief
        self._place: Pose | None = None
        self._next: Step | None = "turn"
        self._turns = 0
        self._to_turn, self._heading = 0.0, 0.0

    def step(self, nothing_left: Callable[[Belief], bool]) -> Step | None:
        """Take the next step where doubt alone leaves nothing to explore; None where the map is sure of it."""
        belief, place = self.belief, self._place
        if place is None or math.dist(place[:2], belief.pose[:2]) >= APART_M:
            self._place, self._next = belief.pose, "turn"
        step = self._next
        if step is None or (step == "turn" and self._turns >= MOST_TURNS):
            return None
        without = belief.snapshot()
        if not without.forget_doubt() or nothing_left(without):
            return None
        if step == "turn":
            self._turns += 1
            self.turn(2.0 * math.pi)
            self._next = "forget"
        else:
            belief.forget_doubt()
            self._next = None
        return step

    @property
    def turning(self) -> bool:
        """Whether a turn is under way."""
        return self._to_turn != 0.0

    def turn(self, angle_rad: float) -> None:
        """Begin to turn by an angle, which may be several turns; positive to the left."""
        self._to_turn, self._heading = angle_rad, self.belief.pose.theta

    def command(self) -> tuple[float, float] | None:
        """Return the command of a turn under way."""
        heading, before = self.belief.pose.theta, self._to_turn
        self._to_turn -= wrap(heading - self._heading)
        self._heading = heading
        if before * self._to_turn <= 0.0:
            self._to_turn = 0.0
            return None
        return 0.0, math.copysign(YAW_RATE_RAD_S, before)
