"""Attribution: counts of decisions by source and of answers by verdict, and their cost."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal, get_args

from coral.advisor.consult import Attempt, Verdict
from coral.advisor.question import Usage, trait

Source = Literal["advisor", "memory", "recording", "fallback"]
"""Source of a decision: the advisor that the run names (which may be rules), an experience memory, a recording of an
earlier advisor, or the fallback because none of them decided."""
Fate = Literal["accepted", "refused", "malformed", "missing"]
"""Fate of a question: an answer that the verifier accepted or refused, a reply that is not an answer, or no reply."""

SOURCES: tuple[Source, ...] = get_args(Source)
FATES: tuple[Fate, ...] = get_args(Fate)
_FATE: Mapping[Verdict, Fate] = {
    "accepted": "accepted",
    "rejected": "refused",
    "malformed": "malformed",
    "unavailable": "missing",
}
"""A withdrawn question has no fate: its answer was no longer needed."""

RECORDED_MODEL = "recorded model (a vision-language model at the desk)"
"""Name of the advisor `recorded` in headlines and tables."""

DEFINITIONS = {
    "decided_by": "Number of decisions by source: the advisor, the memory, a recording, the fallback. Their sum is the "
    "number of decisions.",
    "answers": "Number of questions by fate: accepted, refused by a verifier, malformed (a reply that is no "
    "answer), missing (no reply). A withdrawn question is none of these.",
    "tokens_in": "Tokens that the advisor read; null if a reply did not report them.",
    "tokens_out": "Tokens that the advisor wrote; null if a reply did not report them.",
    "cost_usd": "Cost of the replies (USD); null if the price of one is unknown.",
    "thinking_s": "Sum of the times from question to answer, on the clock of the world (s).",
}


def source_of(advisor: Any) -> Source:
    """Return the source of an advisor's accepted answers: its trait `source` if set, else the advisor itself."""
    source: Source = trait(advisor, "source", "advisor")
    return source


@dataclass(frozen=True, kw_only=True)
class Attribution:
    """Counts of a run's decisions by source. `decided` and `heard` return a copy with one more.

    `Ledger` holds the spending of a single model, and its limits; this counts a whole run with all its advisors.
    """

    decided_by: Mapping[Source, int] = field(default_factory=lambda: dict.fromkeys(SOURCES, 0))
    answers: Mapping[Fate, int] = field(default_factory=lambda: dict.fromkeys(FATES, 0))
    tokens_in: int | None = 0
    """None once a reply did not report them; likewise the other two."""
    tokens_out: int | None = 0
    cost_usd: float | None = 0.0
    thinking_s: float = 0.0

    def decided(self, source: Source) -> Attribution:
        """Count one more decision."""
        return replace(self, decided_by={**self.decided_by, source: self.decided_by[source] + 1})

    def heard(self, verdict: Verdict, cost: Spent, seconds: float) -> Attribution:
        """Count one more question by its verdict."""
        fate = _FATE.get(verdict)
        return replace(
            self,
            answers=self.answers if fate is None else {**self.answers, fate: self.answers[fate] + 1},
            tokens_in=_sum(self.tokens_in, cost.tokens_in),
            tokens_out=_sum(self.tokens_out, cost.tokens_out),
            cost_usd=_sum(self.cost_usd, cost.cost_usd),
            thinking_s=self.thinking_s + seconds,
        )

    def to_json(self) -> dict[str, Any]:
        """Return the keys of `metrics.json`."""
        return {
            "decided_by": dict(self.decided_by),
            "answers": dict(self.answers),
            "tokens_in": self.tokens_in,
            "tokens_out": self.tokens_out,
            "cost_usd": None if self.cost_usd is None else round(self.cost_usd, 6),
            "thinking_s": round(self.thinking_s, 3),
        }


@dataclass(frozen=True)
class Spent:
    """Cost of one attempt, as far as it is known."""

    tokens_in: int | None = None
    tokens_out: int | None = None
    cost_usd: float | None = None


def spent(attempt: Attempt) -> Spent:
    """Compute the cost of an attempt.

    A reply over the wire without a token count is unreported, and so is one with a price of nothing. Without a request
    (rules), or without an answered one, nothing was spent.
    """
    usage: Usage = attempt.usage
    replied = usage.requests > 0 and attempt.verdict in ("accepted", "rejected", "malformed")
    told = not replied or usage.input_tokens + usage.output_tokens > 0
    return Spent(
        tokens_in=usage.input_tokens if told else None,
        tokens_out=usage.output_tokens if told else None,
        cost_usd=usage.cost_usd if usage.cost_usd or not replied else None,
    )


def attribution_of(events: Iterable[Mapping[str, Any]]) -> Attribution:
    """Count the decisions of a run, or of one of its robots, by source.

    A decision is an event that says what was `decided` (poses, parameters, plan, regions, repair, an adopted
    correction), or a goal that was adopted (`goal`) or kept because no new one was found (`held`). The decisions of one
    answer, or of one remembered plan, count once; a missing one that ended the run is the fallback's. The initial
    waypoint, a withdrawn question, and one that found nothing left to explore are no decisions.
    """
    found = Attribution()
    for event in events:
        if event["event"] == "verdict":
            cost = Spent(*(event.get(name) for name in ("tokens_in", "tokens_out", "cost_usd")))
            waited_s = float(event["t"]) - float(event["asked_at"]) if "asked_at" in event else 0.0
            found = found.heard(event["verdict"], cost, float(event.get("thinking_s", waited_s)))
        elif event.get("decided") is not None or (
            event["event"] in ("goal", "held") and event.get("decision") is not None
        ):
            found = found.decided(event["source"])
    return found


def who_decided(
    metrics: Mapping[str, Any],
    *,
    things: str,
    fallback: str,
    advisor: str = "the advisor",
    recording: str = "the recording",
) -> str:
    """Describe who decided, without a full stop; "" if the advisor made every decision, or a run of an older version.

    For example "the advisor decided 5 of 7 goals, the fallback's rules 2". The metrics have the keys `decided_by` and
    `answers`; `things` is the kind of decision, in the plural. Rules decide under the fallback `rules` only.
    """
    by, answers = metrics.get("decided_by") or {}, metrics.get("answers") or {}
    total, own = sum(by.values()), int(by.get("advisor", 0))
    if total == own:
        return f"{advisor} decided nothing" if not total and sum(answers.values()) else ""
    called = {
        "memory": "the memory {}",
        "recording": f"{recording} {{}}",
        "fallback": "the fallback's rules {}" if fallback == "rules" else f"nobody {{}} ({fallback})",
    }
    if by.get("recording", 0) and by["recording"] + by.get("fallback", 0) == total:
        advisor, own = recording, by["recording"]
        called.pop("recording")
    others = [text.format(by[key]) for key, text in called.items() if by.get(key)]
    return ", ".join([f"{advisor} decided {own} of {total} {things}", *others])


def _sum(a: Any, b: Any) -> Any:
    return None if a is None or b is None else a + b
