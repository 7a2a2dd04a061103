"""`coral advisor questions`: make a set of questions for `coral advisor bench`."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from coral.errors import InputError
from coral.exam.generation import CONTACT, REEFS, make_kind_set, make_set, make_unseen_set, make_word_set
from coral.exam.question_set import QuestionSet, save_set


@dataclass(frozen=True, kw_only=True)
class AdvisorQuestions:
    """Generate questions with scored answers from a seed: a set that no model can have seen."""

    seed: int
    """Seed of worlds, paths through them, and trials; the public set has seed 17."""
    out: Path
    """File of the set, such as second.zip; its name is the set's name."""
    reefs: int = 12
    """Number of reefs to generate besides the ten shipped ones."""
    unseen: Literal["development", "test"] | None = None
    """Instead, one question for a plan of each contact task in this half of the unseen suite."""
    words: Literal["development", "test"] | None = None
    """Instead, questions of missions in words of this half, --each missions of each family."""
    kinds: str | None = None
    """Instead, --each questions that show every kind of thing to be named, in this water: a Jerlov type or a preset."""
    distance_m: float | None = None
    """From which, with --kinds; 2 m by default."""
    each: int = 3
    """Missions of each family, with --words; one at which pictures never decide gives no question."""
    share: float = 1.0
    """Share of the usual number of contact questions; below 1, fewer of the shipped reefs too."""
    quiet: bool = False
    """No progress on standard error."""
    json: bool = False
    """Print one JSON object."""

    def __call__(self) -> Mapping[str, Any]:
        """Make the questions."""
        if not 0.0 < self.share <= 1.0:
            raise InputError("--share", "", self.share, "a number above 0, at most 1")
        for flag, value in (("--seed", self.seed), ("--reefs", self.reefs), ("--each", self.each)):
            if value < 0:
                raise InputError(flag, "", value, "a number of 0 or more")
        if self.out.suffix != ".zip" or self.out.exists():
            found = "an existing file" if self.out.exists() else repr(self.out.name)
            raise InputError("--out", "", found, "a new file whose name ends in .zip")
        made = self._make()
        save_set(self.out, made)
        return {
            "set": made.name,
            "file": str(self.out),
            "bytes": self.out.stat().st_size,
            "questions": dict(Counter(item.kind for item in made.items)),
        }

    def _make(self) -> QuestionSet:
        if self.kinds is not None:
            distance_m = 2.0 if self.distance_m is None else self.distance_m
            return make_kind_set(self.out.stem, self.kinds, distance_m, self.seed, self.each)
        if self.distance_m is not None:
            raise InputError("--distance-m", "", self.distance_m, "--kinds WATER beside it")
        if self.words is not None:
            return make_word_set(self.out.stem, self.words, self.seed, self.each)
        if self.unseen is not None:
            return make_unseen_set(self.out.stem, self.unseen, self.seed)
        counts = {kind: max(1, round(self.share * count)) for kind, count in CONTACT.items()}
        reefs = REEFS[: max(1, round(self.share * len(REEFS)))]
        return make_set(self.out.stem, self.seed, self.reefs, counts, self._say, reefs)

    def _say(self, text: str) -> None:
        if not self.quiet:
            print(text, file=sys.stderr, flush=True)

    def describe(self, result: Mapping[str, Any]) -> str:
        """Report the number of questions of each kind, and the file."""
        each = ", ".join(f"{count} {kind}" for kind, count in result["questions"].items())
        total = sum(result["questions"].values())
        return f"{total} questions ({each}) in {result['file']}, {result['bytes'] / 1e6:.1f} MB"
