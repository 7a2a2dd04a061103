"""The decisions of a run: question, trigger, answers, verdicts and result."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from coral.view.run import Record, RunFolder

CAUSES = {
    "first": "first question",
    "distance": "near the goal",
    "stuck": "stuck",
    "failure": "planner failed",
    "deviation": "off the path",
    "own": "own trigger",
    "instruction": "new instruction",
}
"""Why the advisor is asked, by the cause of a trigger."""


@dataclass(frozen=True, kw_only=True)
class Try:
    """One question and its verdict."""

    attempt: int
    asked_at_s: float
    answered_at_s: float | None
    """None if no verdict was recorded."""
    verdict: str
    """"open" if the run ended before one: none was recorded, or the question was withdrawn by the end itself."""
    code: str = ""
    reason: str = ""
    """Reason of a rejection."""
    answer: Mapping[str, Any] = field(default_factory=dict)
    raw: str = ""
    pictures: tuple[tuple[str, str], ...] = ()
    """(name, digest)."""

    @property
    def latency_s(self) -> float | None:
        """Return the simulated seconds from the question to its verdict."""
        return None if self.answered_at_s is None else self.answered_at_s - self.asked_at_s

    @property
    def said(self) -> str:
        """Return the answer in words, without its reasoning."""
        if "selected_centroid_index" in self.answer:
            return _chosen(self.answer)
        if self.answer.get("explore_rest"):
            return "the rest by the robot's own tour"
        if {"forward_m", "left_m"} <= set(self.answer):
            return _moves(self.answer["forward_m"], self.answer["left_m"])
        parts = [
            f"{key.replace('_', ' ')} {value}"
            for key, value in self.answer.items()
            if key not in ("reason", "reasoning") and not isinstance(value, dict | list)
        ]
        return ", ".join(parts) or {"malformed": "not a valid answer", "open": "still open at the end"}.get(
            self.verdict, "no answer"
        )

    @property
    def why(self) -> str:
        """Return the advisor's own reasoning."""
        return str(self.answer.get("reason") or self.answer.get("reasoning") or "")


def _chosen(answer: Mapping[str, Any]) -> str:
    """Return in words what an answer about clusters chose: one of them, or what it may name instead."""
    index, waypoint, look = (answer.get(key) for key in ("selected_centroid_index", "waypoint", "look"))
    if index is not None:
        return f"centroid {index}"
    if isinstance(waypoint, Mapping):
        return _moves(waypoint.get("forward_m", 0), waypoint.get("left_m", 0))
    if isinstance(look, Mapping):
        return f"look at {look.get('dot')} from {look.get('distance_m')} m, {look.get('side')} side"
    if answer.get("done"):
        return f"done: {answer.get('answer') or 'no answer'}"
    return "back to the start" if answer.get("home") else "no centroid"


def _moves(forward: float, left: float) -> str:
    ways = ((forward, "ahead" if forward > 0 else "behind"), (left, "left" if left > 0 else "right"))
    return ", ".join(f"{abs(metres)} m {where}" for metres, where in ways if metres) or "stay here"


def chains(run: RunFolder) -> list[tuple[float, tuple[Record, ...]]]:
    """Return the chain of clusters whenever the run tells it: time (s), and clusters with label and place."""
    told = (
        (float(event["t"]), tuple(c for c in event.get("centroids") or () if {"index", "x", "y"} <= set(c)))
        for event in run.events
    )
    return [(t, chain) for t, chain in told if chain]


def chain_at(run: RunFolder, t: float) -> tuple[Record, ...]:
    """Return the chain of clusters that was told last at time `t` (s)."""
    return next((chain for at, chain in reversed(chains(run)) if at <= t + 1e-6), ())


@dataclass(frozen=True, kw_only=True)
class Decision:
    """One decision, from its trigger to its goal."""

    number: int
    t: float
    cause: str
    """Cause of the last trigger before the question."""
    mode: str
    tries: tuple[Try, ...]
    x: float
    y: float
    """Position of the robot at the time of the question (m); nan if not recorded."""
    goal: tuple[float, float] | None = None
    source: str = ""
    fallback: str = ""

    @property
    def outcome(self) -> str:
        """Return the verdict of the last attempt."""
        return self.tries[-1].verdict

    @property
    def state(self) -> str:
        """Return "good" if the first answer was accepted, "again" if a later one, "idle" if none is due, else "bad"."""
        if self.outcome == "accepted":
            return "good" if len(self.tries) == 1 else "again"
        return "idle" if self.outcome in ("open", "withdrawn") else "bad"

    @property
    def end_s(self) -> float:
        """Return the time of the decision's last event (s)."""
        last = self.tries[-1]
        return last.asked_at_s if last.answered_at_s is None else last.answered_at_s


def decisions(run: RunFolder) -> list[Decision]:
    """Return all decisions of a run in the order of their first question."""
    logged = {(a.get("decision"), a.get("attempt")): a for a in run.attempts}
    verdicts = {(e.get("decision"), e.get("attempt")): e for e in run.select("verdict")}
    questions: dict[Any, list[Record]] = {}
    causes: dict[Any, str] = {}
    cause = ""
    for event in run.events:
        if event["event"] == "trigger" and event.get("fired"):
            cause = str(event.get("cause", ""))
        elif event["event"] == "question":
            questions.setdefault(event.get("decision"), []).append(event)
            causes.setdefault(event.get("decision"), cause)
    goals = {e["decision"]: e for e in run.select("goal") if e.get("decision") is not None}
    fallbacks = run.select("fallback")
    found: list[Decision] = []
    ended_s = max((float(e["t"]) for e in run.select("end")), default=np.inf)
    for key, asked in questions.items():
        tries = tuple(
            _try(q, verdicts.get((key, q.get("attempt"))), logged.get((key, q.get("attempt")), {}), ended_s)
            for q in asked
        )
        t = float(asked[0]["t"])
        times, xs, ys = (run.column(name) for name in ("t", "x", "y"))
        nearest = int(np.clip(np.searchsorted(times, t), 0, len(times) - 1)) if len(times) else -1
        goal = goals.get(key)
        ended = max(float(q["t"]) for q in asked)
        after = next((e for e in fallbacks if e.get("decision", key) == key and float(e["t"]) >= ended), None)
        failed = tries[-1].verdict != "accepted"
        found.append(
            Decision(
                number=int(key) if isinstance(key, int) else len(found),
                t=t,
                cause=causes.get(key, ""),
                mode=str(asked[-1].get("mode", "")),
                tries=tries,
                x=float(xs[nearest]) if nearest >= 0 else float("nan"),
                y=float(ys[nearest]) if nearest >= 0 else float("nan"),
                goal=(float(goal["x"]), float(goal["y"])) if goal else None,
                source=str(goal.get("source", "")) if goal else "",
                fallback=f"{after.get('policy', '')} ({after.get('failure', '')})" if after and failed else "",
            )
        )
    return found


def _try(question: Record, verdict: Record | None, logged: Record, ended_s: float) -> Try:
    verdict = verdict or {}
    if verdict.get("verdict") == "withdrawn" and float(verdict["t"]) >= ended_s - 1e-6:
        verdict, logged = {}, {**logged, "verdict": "open", "answered_at_s": None}
    names = [str(caption[0]) for caption in logged.get("captions") or () if caption]
    names += ["map", "segmentation", "depth"][len(names) :]
    digests = [str(digest) for digest in question.get("pictures") or ()]
    pictures = tuple((names[k] if k < len(names) else f"picture {k + 1}", d) for k, d in enumerate(digests))
    answer = verdict.get("answer") or logged.get("answer") or {}
    at = verdict.get("asked_at")
    return Try(
        attempt=int(question.get("attempt") or 0),
        asked_at_s=float(at if at is not None else question["t"]),
        answered_at_s=float(verdict["t"]) if "t" in verdict else logged.get("answered_at_s"),
        verdict=str(verdict.get("verdict") or logged.get("verdict") or "open"),
        code=str(verdict.get("code") or logged.get("code") or ""),
        reason=str(verdict.get("reason") or logged.get("reason") or ""),
        answer=answer if isinstance(answer, dict) else {"answer": answer},
        raw=str(logged.get("raw") or ""),
        pictures=pictures,
    )
