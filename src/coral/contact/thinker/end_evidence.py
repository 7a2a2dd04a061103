"""What the record says about the end of the active stage: which of its comparisons do not hold, and by how much."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from coral.contact.plan.stage_end import TRUTH, UNKNOWN, EndPart, PartReading
from coral.contact.thinker.progress_monitor import PlanNote
from coral.words import is_numeral

END_S = 2.0
"""Time at the end of the record in which a comparison holds or does not, and targets are at the edge."""
NEAR = {"m": 0.015, "m/s": 0.03, "rad/s": 0.3, "N": 1.0, "": 0.03}
"""By unit, what misses by little. The planner stops one to two centimetres short of what it is led to, and shakes hand
and objects by some centimetres a second; of what has no unit, such as 1 - cos of an angle, 0.03 (14 degrees)."""
COUNTS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")


@dataclass(frozen=True)
class PartEvidence:
    """What became of one comparison of the end."""

    part: EndPart
    held: float
    """Share of the last plans at which it held."""
    best: float
    """Its left side where it was nearest to holding, in the record."""
    now: float
    """Its left side at the end, the median of the last plans."""
    bound: float
    """Its right side at the end, likewise."""
    first_missing: float
    """How far it was from holding when the stage began."""
    missing: float
    """How far it is now, the median of the last plans."""

    @property
    def holds(self) -> bool:
        """Return whether it held at most of the last plans."""
        return self.held >= 0.5

    @property
    def is_near(self) -> bool:
        """Return whether it misses by no more than a planner leaves."""
        return self.missing <= NEAR.get(self.part.unit, 0.0)

    def words(self) -> str:
        """Return it with its values."""
        if self.part.unit == TRUTH and self.part.operator in ("holds", "fails"):
            return f"`{self.part.text}`, which is {'true' if self.now > 0.5 else 'false'} now"
        if self.part.operator in ("holds", "fails"):
            return f"`{self.part.text}`, which does not hold"
        unit = "" if self.part.unit in (TRUTH, UNKNOWN) else f" {self.part.unit}".rstrip()
        asked = "" if is_numeral(self.part.right) else f" against {self.bound:.3g}{unit}"
        return f"`{self.part.text}`: {self.best:.3g}{unit} at best, {self.now:.3g}{unit} now{asked}"


@dataclass(frozen=True)
class EndEvidence:
    """What became of the end of the active stage."""

    stage: str
    parts: tuple[PartEvidence, ...]
    """Its comparisons; () if they are unknown."""

    @property
    def unmet(self) -> tuple[PartEvidence, ...]:
        """Return the comparisons that do not hold."""
        return tuple(part for part in self.parts if not part.holds)

    @property
    def _is_placed(self) -> bool:
        return any(part.holds and part.part.unit == "m" for part in self.parts)

    @property
    def misses_by_little(self) -> bool:
        """Return whether the stage nearly ends: all that does not hold is a length, speed or the like just missed.

        Lengths must have come nearer, by half since the stage began, unless another length of the end holds: an object
        that should move a centimetre and does not move has not nearly moved.
        """
        lengths = [part for part in self.unmet if part.part.unit == "m"]
        came = self._is_placed or all(part.missing <= 0.5 * part.first_missing for part in lengths)
        return bool(self.parts) and came and all(part.is_near for part in self.unmet)

    @property
    def lacks_only_a_contact(self) -> bool:
        """Return whether the stage is where its end wants it to be, and only a truth value does not hold."""
        return self._is_placed and bool(self.unmet) and all(part.part.unit == TRUTH for part in self.unmet)

    def recedes(self, by_m: float) -> bool:
        """Return whether all the lengths that do not hold are farther from holding than when the stage began."""
        lengths = [part for part in self.unmet if part.part.unit == "m"]
        others = all(part.part.unit == "m" or part.is_near for part in self.unmet)
        return bool(lengths) and others and all(part.missing > part.first_missing + by_m for part in lengths)

    def sentences(self) -> list[str]:
        """Return the evidence in a sentence, for prompts and events; none if it is unknown."""
        if not self.parts:
            return []
        count = len(self.parts)
        if not self.unmet:
            return [f"Stage {self.stage!r} ends when {_number(count)} comparisons hold: each did, not all at once."]
        told = "; and ".join(part.words() for part in self.unmet)
        met = count - len(self.unmet)
        others = "" if count == 1 else f"; {_others(met, count)}"
        return [f"Stage {self.stage!r} ends when {told}{others}."]


def collect_end(notes: Sequence[PlanNote], first: Mapping[str, tuple[PartReading, ...]] | None = None) -> EndEvidence:
    """Collect what became of the end of the last stage.

    `first` has the comparisons as they were when each stage began; by default the beginning of the record counts.
    """
    if not notes:
        return EndEvidence("", ())
    stage = notes[-1].stage
    readings = [note.end for note in notes if note.stage == stage and note.end]
    late = [note.end for note in notes if note.stage == stage and note.end and note.time_s > notes[-1].time_s - END_S]
    if not late:
        return EndEvidence(stage, ())
    began = (first or {}).get(stage, readings[0])
    parts = []
    for k, reading in enumerate(late[-1]):
        best = min((each[k] for each in readings), key=lambda one: one.missing)
        parts.append(
            PartEvidence(
                part=reading.part,
                held=float(np.mean([each[k].holds for each in late])),
                best=best.left,
                now=float(np.median([each[k].left for each in late])),
                bound=float(np.median([each[k].right for each in late])),
                first_missing=began[k].missing,
                missing=float(np.median([each[k].missing for each in late])),
            )
        )
    return EndEvidence(stage, tuple(parts))


def _others(met: int, count: int) -> str:
    whole = f"of its {_number(count)} parts"
    if met == 0:
        return f"none {whole} holds"
    return f"the other {whole} holds" if met == 1 else f"the other {_number(met)} {whole} hold"


def _number(count: int) -> str:
    return COUNTS[count] if count < len(COUNTS) else str(count)
