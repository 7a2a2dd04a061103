"""Result of one advisor on a set: score with interval, scores by kind, cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.exam.grading import Graded

RESAMPLES, SEED, LEVEL = 4000, 20260314, 0.95
"""Of the bootstrap; the fixed seed makes intervals reproducible."""


@dataclass(frozen=True, kw_only=True)
class Result:
    """Result of one advisor: a row of the table."""

    name: str
    """Name of the advisor."""
    graded: tuple[Graded, ...]
    """Every question with its answer and score."""

    def row(self) -> dict[str, Any]:
        """Return the row as plain values for JSON.

        `score` is the mean of the kinds' means, so that a kind with more questions weighs no more; `low` and `high`
        bound it in 95 % of the bootstrap samples, which redraw whole worlds and tasks within each kind.
        """
        kinds = list(dict.fromkeys(one.sheet.item.kind for one in self.graded))
        by_kind, means = {}, []
        for number, kind in enumerate(kinds):
            of_kind = [one for one in self.graded if one.sheet.item.kind == kind]
            scores = [one.worth.score for one in of_kind]
            samples = _bootstrap_means(scores, [one.sheet.item.group for one in of_kind], number)
            means.append(samples)
            by_kind[kind] = {"score": _round(np.mean(scores)), **_interval(samples), "questions": len(of_kind)}
        usage = [one.sheet.usage for one in self.graded]
        replied = [one for one in usage if one.requests]
        told = all(one.input_tokens + one.output_tokens for one in replied)
        priced = all(one.cost_usd for one in replied)
        seconds = [one.sheet.seconds for one in self.graded if one.sheet.seconds is not None]
        return {
            "name": self.name,
            "score": _round(np.mean([kind["score"] for kind in by_kind.values()])),
            **_interval(np.mean(means, axis=0)),
            "by_kind": by_kind,
            "questions": len(self.graded),
            "answered": sum(one.sheet.answer is not None for one in self.graded),
            "refused": sum(one.worth.why.startswith("refused") for one in self.graded),
            "tokens_in": sum(one.input_tokens for one in usage) if told else None,
            "tokens_out": sum(one.output_tokens for one in usage) if told else None,
            "cost_usd": round(sum(one.cost_usd for one in usage), 6) if priced else None,
            "latency_s_median": round(float(np.median(seconds)), 3) if seconds else None,
        }

    def worst(self, count: int) -> list[Graded]:
        """Return the answers with the lowest scores, from as many kinds of question as possible."""
        by_kind: dict[str, list[Graded]] = {}
        for one in sorted(self.graded, key=lambda one: one.worth.score):
            if one.sheet.answer is not None and one.worth.score < 1.0:
                by_kind.setdefault(one.sheet.item.kind, []).append(one)
        found: list[Graded] = []
        while len(found) < count and any(by_kind.values()):
            found += [of_kind.pop(0) for of_kind in by_kind.values() if of_kind]
        return found[:count]


def _bootstrap_means(scores: Sequence[float], groups: Sequence[str], stream: int) -> NDArray[np.float64]:
    """Compute the means of bootstrap samples that redraw whole groups with replacement. Shape=(RESAMPLES,)."""
    names = {group: k for k, group in enumerate(dict.fromkeys(groups))}
    member = np.array([names[group] for group in groups])
    sums, counts = np.bincount(member, scores), np.bincount(member).astype(np.float64)
    draws = np.random.default_rng([SEED, stream]).integers(0, len(sums), size=(RESAMPLES, len(sums)))
    return np.asarray(sums[draws].sum(axis=1) / counts[draws].sum(axis=1))


def _interval(samples: NDArray[np.float64]) -> dict[str, float]:
    low, high = np.percentile(samples, [50 * (1 - LEVEL), 50 * (1 + LEVEL)])
    return {"low": _round(low), "high": _round(high)}


def _round(value: Any) -> float:
    return round(float(value), 4)
