"""`coral advisor questions`: make a set of questions for `coral advisor bench`."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from coral.errors import InputError
from coral.exam.generation import CONTACT, REEFS, make_set, make_unseen_set
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
        for flag, value in (("--seed", self.seed), ("--reefs", self.reefs)):
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
