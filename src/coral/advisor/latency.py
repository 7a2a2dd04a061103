"""Latency of an advisor, in seconds of the world's clock."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from coral.advisor.question import trait
from coral.errors import InputError, nearest
from coral.words import is_numeral

LatencyKind = Literal["fixed", "lognormal", "measured", "recorded"]

FORMS = "0, SECONDS, fixed:SECONDS, lognormal:MEDIAN:SIGMA, measured or recorded"


@dataclass(frozen=True, kw_only=True)
class LatencyCfg:
    """A distribution of reply times."""

    kind: LatencyKind = "fixed"
    """fixed and lognormal are drawn when the question is asked; measured is the advisor's wall time; recorded is
    stated by the reply itself (a replayed run)."""
    median_s: float = 10.0
    """Median (s). The CORAL paper reports 10 s for its VLM, and 5 s for DREAM's."""
    sigma: float = 0.0
    """Standard deviation of the natural logarithm of the reply time (lognormal only)."""

    def draw(self, rng: np.random.Generator) -> float | None:
        """Draw the reply time of one question (s); None if only the reply can tell."""
        if self.kind == "fixed":
            return self.median_s
        if self.kind == "lognormal":
            return self.median_s * math.exp(self.sigma * float(rng.standard_normal()))
        return None

    def __str__(self) -> str:
        if self.kind == "fixed":
            return f"fixed:{self.median_s:g}"
        return f"lognormal:{self.median_s:g}:{self.sigma:g}" if self.kind == "lognormal" else self.kind


def parse_latency(spec: str, where: str = "--cfg.latency") -> LatencyCfg:
    """Read a latency as written on the command line, such as "fixed:10" or "lognormal:10:0.3".

    Raises:
        InputError: The text has none of the known forms, or a number is negative or not finite.
    """
    kind, *rest = spec.strip().split(":")
    if kind in ("measured", "recorded") and not rest:
        return LatencyCfg(kind="measured" if kind == "measured" else "recorded")
    if not rest:
        kind, rest = ("fixed", [kind]) if is_numeral(kind) else (kind, rest)
    wanted = {"fixed": 1, "lognormal": 2}.get(kind)
    if wanted is None:
        raise InputError(where, "", repr(spec), FORMS + nearest(kind, ["fixed", "lognormal", "measured", "recorded"]))
    if len(rest) != wanted or not all(is_numeral(x) for x in rest):
        raise InputError(where, "", repr(spec), FORMS)
    numbers = [float(x) for x in rest]
    if any(not math.isfinite(x) or x < 0 for x in numbers):
        raise InputError(where, "", repr(spec), "finite numbers of 0 or more")
    if kind == "fixed":
        return LatencyCfg(kind="fixed", median_s=numbers[0])
    return LatencyCfg(kind="lognormal", median_s=numbers[0], sigma=numbers[1])


def default_latency(advisor: Any) -> LatencyCfg:
    """Return an advisor's own latency (its trait `latency`, a spec); measured if it has none."""
    return parse_latency(str(trait(advisor, "latency", "measured")), f"advisor {getattr(advisor, 'name', '?')}")


def latency_for(advisor: Any, spec: str = "auto") -> LatencyCfg:
    """Return the latency that a mission simulates; "auto" is the advisor's own. A recording keeps the recorded ones.

    Raises:
        InputError: The spec has none of the known forms.
    """
    own = default_latency(advisor)
    return own if spec == "auto" or own.kind == "recorded" else parse_latency(spec)
