"""Attribution: counts of decisions by source and of answers by verdict, and their cost."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
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


def spent(attempt: Attempt) -> dict[str, float | None]:
    """Compute the cost of an attempt: `tokens_in`, `tokens_out` and `cost_usd`, None as far as it is unknown.

    A reply over the wire without a token count is unreported, and so is one with a price of nothing. Without a request
    (rules), or without an answered one, nothing was spent.
    """
    usage: Usage = attempt.usage
    replied = usage.requests > 0 and attempt.verdict in ("accepted", "rejected", "malformed")
    told = not replied or usage.input_tokens + usage.output_tokens > 0
    return {
        "tokens_in": usage.input_tokens if told else None,
        "tokens_out": usage.output_tokens if told else None,
        "cost_usd": usage.cost_usd if usage.cost_usd or not replied else None,
    }


def attribution_of(events: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """Count the decisions of a run, or of one of its robots, by source; return the metrics that `DEFINITIONS` explains.

    A decision is an event that says what was `decided` (poses, parameters, plan, regions, repair, an adopted
    correction), or a goal that was adopted (`goal`) or kept because no new one was found (`held`). The decisions of one
    answer, or of one remembered plan, count once; a missing one that ended the run is the fallback's. The initial
    waypoint, a withdrawn question, and one that found nothing left to explore are no decisions.
    """
    decided_by, answers = dict.fromkeys(SOURCES, 0), dict.fromkeys(FATES, 0)
    costs: dict[str, Any] = {"tokens_in": 0, "tokens_out": 0, "cost_usd": 0.0}
    thinking_s = 0.0
    for event in events:
        if event["event"] == "verdict":
            if (fate := _FATE.get(event["verdict"])) is not None:
                answers[fate] += 1
            for name, total in costs.items():
                amount = event.get(name)
                costs[name] = None if total is None or amount is None else total + amount
            waited_s = float(event["t"]) - float(event["asked_at"]) if "asked_at" in event else 0.0
            thinking_s += float(event.get("thinking_s", waited_s))
        elif event.get("decided") is not None or (
            event["event"] in ("goal", "held") and event.get("decision") is not None
        ):
            decided_by[event["source"]] += 1
    if costs["cost_usd"] is not None:
        costs["cost_usd"] = round(costs["cost_usd"], 6)
    return {"decided_by": decided_by, "answers": answers, **costs, "thinking_s": round(thinking_s, 3)}


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
