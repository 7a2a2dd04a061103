"""Attribution: counts of decisions by source and of answers by verdict, and their cost."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal, get_args

from coral.advisor.consult import Attempt, Verdict
from coral.advisor.fallback import Fallback
from coral.advisor.question import Usage

Source = Literal["advisor", "memory", "recording", "fallback"]
"""Who made a decision: the advisor that the run names (rules, where they are the advisor), an experience memory, a
recording of an earlier advisor, or the fallback because none of them did."""
Fate = Literal["accepted", "refused", "malformed", "missing"]
"""What became of a question: an answer that the verifier took or refused, a reply that is no answer, or no reply."""

SOURCES: tuple[Source, ...] = get_args(Source)
FATES: tuple[Fate, ...] = get_args(Fate)
_FATE: Mapping[Verdict, Fate] = {
    "accepted": "accepted",
    "rejected": "refused",
    "malformed": "malformed",
    "unavailable": "missing",
}
"""A question that was withdrawn has no fate: nobody waited for its answer."""

DEFINITIONS = {
    "decided_by": "Decisions by their source: the advisor, the memory, a recording, the fallback. Their sum is the "
    "number of decisions.",
    "answers": "Questions by what came of them: accepted, refused by a verifier, malformed (a reply that is no "
    "answer), missing (no reply). A question that was withdrawn is none of these.",
    "tokens_in": "Tokens that the advisor read; none where a reply did not tell.",
    "tokens_out": "Tokens that the advisor wrote; none where a reply did not tell.",
    "cost_usd": "What the replies cost (USD); none where the price of one is not known.",
    "thinking_s": "Time from the questions to their answers, summed, on the clock of the world (s).",
}


def source_of(advisor: Any) -> Source:
    """Return the source of an advisor's accepted answers: its attribute `source` if set, else the advisor itself."""
    source: Source = getattr(advisor, "source", "advisor")
    return source


@dataclass(frozen=True, kw_only=True)
class Attribution:
    """Counts of a run's decisions by source. `decided` and `attempted` return a copy with one more.

    Spending of a single model, and its bounds, are in `Ledger`; this is of a whole run, whoever answered.
    """

    decided_by: Mapping[Source, int] = field(default_factory=lambda: dict.fromkeys(SOURCES, 0))
    answers: Mapping[Fate, int] = field(default_factory=lambda: dict.fromkeys(FATES, 0))
    tokens_in: int | None = 0
    """None once a reply did not tell; so with the other two."""
    tokens_out: int | None = 0
    cost_usd: float | None = 0.0
    thinking_s: float = 0.0

    def decided(self, source: Source) -> Attribution:
        """Count one more decision."""
        return replace(self, decided_by={**self.decided_by, source: self.decided_by[source] + 1})

    def attempted(self, attempt: Attempt) -> Attribution:
        """Count one more question, as `consult` logs it."""
        return self.heard(attempt.verdict, spent(attempt), attempt.answered_at_s - attempt.asked_at_s)

    def heard(self, verdict: Verdict, cost: Spent, seconds: float) -> Attribution:
        """Count one more question by its verdict.

        Args:
            verdict: Of the attempt.
            cost: Of the attempt.
            seconds: From question to verdict, on the clock of the world.
        """
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

    A reply that came over the wire and counts no tokens is one that did not tell; so is a price of nothing. Where no
    request was made (rules), or none was answered, nothing was spent.
    """
    usage: Usage = attempt.usage
    replied = usage.requests > 0 and attempt.verdict in ("accepted", "rejected", "malformed")
    told = not replied or usage.input_tokens + usage.output_tokens > 0
    return Spent(
        tokens_in=usage.input_tokens if told else None,
        tokens_out=usage.output_tokens if told else None,
        cost_usd=usage.cost_usd if usage.cost_usd or not replied else None,
    )


def who_decided(metrics: Mapping[str, Any], *, things: str, fallback: Fallback, advisor: str = "the advisor") -> str:
    """Say who decided, without a full stop; "" if the advisor made every decision.

    Such as "the advisor decided 5 of 7 goals, the fallback's rules 2".

    Args:
        metrics: With the keys `decided_by` and `answers`; "" where a run of an older version has none.
        things: What is decided, in the plural: "goals".
        fallback: The policy that was chosen.
        advisor: How to call the advisor.
    """
    by, answers = metrics.get("decided_by") or {}, metrics.get("answers") or {}
    total, own = sum(by.values()), int(by.get("advisor", 0))
    if total == own:
        return f"{advisor} decided nothing" if not total and sum(answers.values()) else ""
    called = {
        "memory": "the memory {}",
        "recording": "the recording {}",
        "fallback": "the fallback's rules {}" if fallback == "rules" else f"nobody {{}} ({fallback})",
    }
    others = [text.format(by[key]) for key, text in called.items() if by.get(key)]
    return ", ".join([f"{advisor} decided {own} of {total} {things}", *others])


def _sum(a: Any, b: Any) -> Any:
    return None if a is None or b is None else a + b
