"""Guesses: what an advisor expects beyond the map, how such guesses came out, and what the next one may cost."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from coral.reef.map.belief import Belief

NEAR_M = 2.0
"""A guess is right if oysters lie this near to its place; what is known there already is no guess."""
SEEN_SHARE = 0.9
"""It has come out once this share of the water within `NEAR_M` of its place is explored."""
ALLOWANCE_S = 30.0
"""What a guess may cost before any has come out: three answers of the paper's median latency."""


@dataclass(frozen=True, kw_only=True)
class Guess:
    """Oysters that an advisor expects where the map shows none."""

    x: float
    y: float
    """Where (m, world)."""
    what: str
    sure: float
    """From 0 to 1, by the advisor's own word."""
    hit: bool | None = None
    """Whether there were oysters; None until the robot has looked."""


@dataclass(frozen=True)
class GuessRecord:
    """How the guesses of a mission came out."""

    guesses: tuple[Guess, ...] = ()

    @property
    def right(self) -> int:
        """Return the number of guesses that were right."""
        return sum(guess.hit is True for guess in self.guesses)

    @property
    def wrong(self) -> int:
        """Return the number of guesses that were wrong."""
        return sum(guess.hit is False for guess in self.guesses)

    def allowance_s(self, sure: float) -> float:
        """Return how much later the rest may be seen for the next guess (s).

        The share of right guesses is taken to be (right + 1) / (all + 2), one half before any (Laplace's rule).
        """
        share = (self.right + 1) / (self.right + self.wrong + 2)
        return 2.0 * share * sure * ALLOWANCE_S

    def settled(self, belief: Belief) -> tuple[GuessRecord, list[Guess]]:
        """Judge the open guesses by the present map. Return the new record, and the guesses that have come out."""
        guesses = tuple(_judged(guess, belief) for guess in self.guesses)
        out = [new for old, new in zip(self.guesses, guesses, strict=True) if old.hit is None and new.hit is not None]
        return GuessRecord(guesses), out

    def with_guess(self, guess: Guess, belief: Belief) -> GuessRecord:
        """Note a guess, unless oysters are known there or the same was guessed already."""
        again = any(one.hit is None and math.dist((one.x, one.y), (guess.x, guess.y)) <= NEAR_M for one in self.guesses)
        return self if again or oysters_near(belief, guess.x, guess.y) else GuessRecord((*self.guesses, guess))


def oysters_near(belief: Belief, x: float, y: float) -> bool:
    """Check whether the map shows oysters near a point, doubtful ones left out."""
    return any(math.dist((t.x, t.y), (x, y)) <= NEAR_M for t in belief.tracks if not t.doubtful)


def _judged(guess: Guess, belief: Belief) -> Guess:
    if guess.hit is not None:
        return guess
    if oysters_near(belief, guess.x, guess.y):
        return replace(guess, hit=True)
    seen = 1.0 - belief.map.unexplored_share(guess.x, guess.y, NEAR_M)
    return replace(guess, hit=False) if seen >= SEEN_SHARE else guess
