"""The reasoning of a contact episode (paper, Fig. 6), and every answer of the advisor."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import cv2

from coral.drawing import webp_url
from coral.foreign_file import read_picture_file
from coral.view.run import Record, RunFolder
from coral.words import many

ASKED = {
    "object-poses": "where the objects are",
    "physical-parameters": "masses and frictions",
    "cost-function": "the cost",
    "contact-regions": "where to touch",
    "cost-repair": "a better cost",
    "parameter-repair": "corrected parameters",
    "unified": "everything at once",
}
"""Names of the kinds of question."""
FAILED = {
    "requeries-used-up": "no answer passed the checks",
    "deadline": "no answer came in time",
    "silence": "no answer came",
    "no-better-fit": "no mass and friction explain the history better",
}
"""Reasons for giving up a question; other codes are shown as they are."""


@dataclass(frozen=True, kw_only=True)
class ThoughtPart:
    """One step of the reasoning."""

    title: str
    """Kind of the step."""
    state: str = ""
    """"good", "bad", "warn" or ""."""
    chips: tuple[str, ...] = ()
    """Short facts."""
    text: str = ""
    """A sentence or two, in the advisor's words if there are any."""
    refused: tuple[str, ...] = ()
    """Reasons for refused answers, in order."""
    code: str = ""
    """Resulting programs."""
    rows: tuple[tuple[str, ...], ...] = ()
    """A small table; its first row is the header."""


@dataclass(frozen=True, kw_only=True)
class Thought:
    """The reasoning at one moment."""

    t: float
    """Simulated time (s)."""
    title: str
    """Cause of the reasoning."""
    state: str
    """As in `ThoughtPart`."""
    parts: tuple[ThoughtPart, ...]
    """Its steps in order."""


@dataclass(frozen=True, kw_only=True)
class Answer:
    """One attempt at a question, with its order among the attempts instead of a time."""

    number: str
    asked: str
    verdict: str
    spoilt: str
    reason: str
    raw: str


def thoughts(run: RunFolder) -> list[Thought]:
    """Return the reasoning of a run, moment by moment."""
    moments: dict[tuple[int, float], list[Record]] = {}
    for event in run.select(*_PARTS):
        moments.setdefault((int(event.get("step", 0)), float(event["t"])), []).append(event)
    found = []
    for (step, t), events in moments.items():
        kinds = [str(event["event"]) for event in events]
        # A strategy's description alone, as in runs without an advisor, repeats the stages.
        if set(kinds) == {"strategy"}:
            continue
        title, state = _cause(kinds, step)
        parts = tuple(_PARTS[kind](event) for kind, event in zip(kinds, events, strict=True))
        found.append(Thought(t=t, title=title, state=state, parts=parts))
    return found


def answers(run: RunFolder) -> list[Answer]:
    """Return every answer of the advisor, accepted or not."""
    found = []
    for entry in run.attempts:
        spoilt = [
            str(fault).removeprefix("sloppy-").replace("-", " ")
            for fault in entry.get("usage", {}).get("faults", ())
            if str(fault).startswith("sloppy-")
        ]
        verdict = str(entry.get("verdict", ""))
        code = str(entry.get("code", ""))
        found.append(
            Answer(
                number=f"{int(entry.get('decision', 0)) + 1}.{int(entry.get('attempt', 0)) + 1}",
                asked=ASKED.get(str(entry.get("kind")), str(entry.get("kind"))),
                verdict=verdict,
                spoilt=", ".join(spoilt),
                reason=f"{code}: {entry.get('reason', '')}" if code else "",
                raw=str(entry.get("raw", ""))[:4000] if verdict not in ("accepted", "") else "",
            )
        )
    return found


def counted(given: list[Answer]) -> str:
    """Count the answers in a sentence."""
    if not given:
        return ""
    wrong = [one for one in given if one.verdict in ("rejected", "malformed")]
    absent = sum(one.verdict in ("unavailable", "withdrawn") for one in given)
    spoilt = [one for one in given if one.spoilt]
    passed = sum(one.verdict == "accepted" for one in spoilt)
    said = [f"{many(len(given), 'question')} asked, {many(len(given) - len(wrong) - absent, 'answer')} accepted"]
    said += [f"{len(wrong)} refused"] if wrong else []
    said += [f"{absent} without an answer"] if absent else []
    were = f" {many(len(spoilt), 'answer')} {'were' if len(spoilt) > 1 else 'was'} spoilt on purpose; "
    tail = f"{were}{passed or 'none'} of them passed the checks." if spoilt else ""
    return f"{', '.join(said)}.{tail}"


def seen(run: RunFolder) -> str:
    """Return the first picture of a question, as a data URL; "" if there was none."""
    for entry in run.attempts:
        for digest in entry.get("pictures", ()):
            path = run.picture(str(digest))
            picture = None if path is None else read_picture_file(path, cv2.IMREAD_COLOR)
            if picture is not None:
                return webp_url(picture[..., ::-1])
    return ""


def _cause(kinds: list[str], step: int) -> tuple[str, str]:
    if "cost_error" in kinds:
        return "The cost failed while it was in use", "bad"
    if "stuck" in kinds:
        return "Stuck: the outer loop asks again", "warn"
    if "remembered" in kinds:
        return "Stored in the memory", "good"
    return ("At the start" if step == 0 else "Asked again"), ""


def _beliefs(event: Record) -> ThoughtPart:
    named = {
        key: value
        for key, value in event.items()
        if isinstance(value, list) and len(value) == 2 and all(isinstance(one, int | float) for one in value)
    }
    undecided = _undecided(event)
    given = "Given on the command line." if event.get("source") == "given" else _attempts_text(event)
    return ThoughtPart(
        title="Masses and frictions",
        state="bad" if undecided else "",
        chips=tuple(f"{name}: {mass:.3g} kg, friction {friction:.2g}" for name, (mass, friction) in named.items()),
        text=undecided or given,
        refused=_refusals(event),
    )


def _poses(event: Record) -> ThoughtPart:
    named = {key: value for key, value in event.items() if isinstance(value, list) and len(value) == 7}
    chips = tuple(f"{name} at {', '.join(f'{100 * v:.1f}' for v in value[:3])} cm" for name, value in named.items())
    return ThoughtPart(
        title="Estimated object poses, used from now on",
        state="warn",
        chips=chips,
        text=_attempts_text(event),
        refused=_refusals(event),
    )


def _recall(event: Record) -> ThoughtPart:
    title = f"Memory {event['id']} was"
    known = f"It is similar by {float(event['similarity']):.2f} and differs by {float(event['distance']):.2f}"
    if event.get("refused"):
        return ThoughtPart(title=f"{title} not used", state="warn", text=f"{known}.", refused=(str(event["refused"]),))
    if outcome := event.get("outcome"):
        stages = f"came through {100 * float(outcome['stages']):.0f} % of its stages"
        ended = "succeeded" if outcome["succeeded"] else stages
        known += f"; in an imagined run for {float(event['rehearsed_s']):.0f} s it {ended}"
    return ThoughtPart(title=f"{title} used", state="good", text=f"{known}. No question about a plan was needed.")


def _recall_repair(event: Record) -> ThoughtPart:
    if refused := str(event["refused"]):
        return ThoughtPart(title="The remembered repair was not used", state="warn", refused=(refused,))
    return ThoughtPart(title="The remembered repair was used", state="good", text=str(event["explanation"]))


def _plan(event: Record) -> ThoughtPart:
    again = event["kind"] == "cost-repair"
    title = "A better plan" if again else "The plan"
    if failure := str(event.get("failure", "")):
        why = f"{_describe_failure(failure).capitalize()}."
        return ThoughtPart(title=f"{title}: none", state="bad", text=why, refused=_refusals(event))
    return ThoughtPart(
        title=title,
        state="good" if again else "",
        text=str(event.get("explanation", "")),
        refused=_refusals(event),
        code=str(event.get("code", "")),
    )


def _regions(event: Record) -> ThoughtPart:
    held: Mapping[str, Any] = event.get("regions", {})
    chips = tuple(
        f"{name}, {region.get('approach') or 'touch'}{': ' + region['stage'] if region.get('stage') else ''}"
        for name, item in held.items()
        for region in item.get("regions", ())
    )
    undecided = _undecided(event)
    state = "bad" if undecided else ""
    return ThoughtPart(title="Contact regions", state=state, chips=chips, refused=_refusals(event), text=undecided)


def _candidates(event: Record) -> ThoughtPart:
    said = []
    for item in event.get("regions", ()):
        lost: Mapping[str, int] = item["lost"]
        stage = f" for {item['stage']}" if item.get("stage") else ""
        said.append(
            f"{item['kept']} of {item['kept'] + sum(lost.values())} are left on the {item['object']}{stage}; "
            f"{', '.join(f'{count} {reason}' for reason, count in lost.items())}."
        )
    return ThoughtPart(title="Some points cannot be touched", text=" ".join(said))


def _stuck(event: Record) -> ThoughtPart:
    said = str(event.get("text", ""))
    head = ("time (s)", "object (m)", "moved (mm)", "hand (m)", "force on the hand (N)", "cost")
    rows = [
        (
            f"{row['time_s']:.2f}",
            _numbers(row["object_pos"], 3),
            f"{row['object_moved_mm']:.1f}",
            _numbers(row["hand_pos"], 3),
            _numbers(row["force_on_hand_n"], 1),
            "–" if row.get("cost") is None else f"{row['cost']:.3g}",
        )
        for row in event.get("history", ())
    ]
    stage, object_ = f"stage “{event.get('stage')}”", f"object: {event.get('object')}"
    return ThoughtPart(
        title=f"Diagnosis: {str(event.get('diagnosis', '')).replace('-', ' ')}",
        state="warn",
        text=f"{said[:1].upper()}{said[1:]}.",
        chips=(stage, f"{event.get('attempts')} attempts without progress", object_),
        rows=(head, *rows) if rows else (),
    )


def _correction(event: Record) -> ThoughtPart:
    accepted, name = bool(event.get("accepted")), event.get("object")
    errors = event.get("errors")
    chips: tuple[str, ...] = ()
    if accepted and "before" in event and "after" in event:
        (m0, f0), (m1, f1) = event["before"], event["after"]
        chips = (f"mass {m0:.3g} → {m1:.3g} kg", f"friction {f0:.2g} → {f1:.2g}")
    if errors:
        chips += (f"replay error over all windows {errors[0]:.2f} → {errors[1]:.2f}",)
    said = str(event.get("text", ""))
    return ThoughtPart(
        title=f"World model of the {name}: {'corrected' if accepted else 'kept'}",
        chips=chips,
        state="good" if accepted else "",
        refused=_refusals(event),
        text=f"{said[:1].upper()}{said[1:]}{'' if said.endswith('.') or not said else '.'}",
    )


def _cost_error(event: Record) -> ThoughtPart:
    title, chips = "The cost could not be evaluated", (str(event.get("code")),)
    where = f"In stage “{event.get('stage')}”: {event.get('reason')}."
    return ThoughtPart(title=title, state="bad", chips=chips, text=where)


def _fallback(event: Record) -> ThoughtPart:
    why = _describe_failure(str(event.get("because")))
    titles = {"nobody": "The advisor did not decide: the episode ends", "the plan before": "The plan stays"}
    by = str(event.get("by"))
    title = titles.get(by, f"The fallback decided: {by}")
    return ThoughtPart(title=title, state="bad", text=f"On the {event.get('what')}: {why}.")


def _remembered(event: Record) -> ThoughtPart:
    text = f"This success is number {event.get('id')} in {event.get('file')}."
    return ThoughtPart(title="Remembered", state="good", text=text)


def _strategy(event: Record) -> ThoughtPart:
    return ThoughtPart(title=f"Follows “{event.get('name')}”", chips=tuple(map(str, event.get("stages", ()))))


_PARTS: Mapping[str, Callable[[Record], ThoughtPart]] = {
    "poses": _poses,
    "beliefs": _beliefs,
    "recall": _recall,
    "recall_repair": _recall_repair,
    "plan_answer": _plan,
    "regions": _regions,
    "candidates": _candidates,
    "stuck": _stuck,
    "correction": _correction,
    "cost_error": _cost_error,
    "fallback": _fallback,
    "remembered": _remembered,
    "strategy": _strategy,
}


def _refusals(event: Record) -> tuple[str, ...]:
    return tuple(str(reason) for reason in event.get("refused", ()))


def _attempts_text(event: Record) -> str:
    count = int(event.get("attempts", 1))
    return "" if count <= 1 else f"Accepted at attempt {count}."


def _describe_failure(code: str) -> str:
    return FAILED.get(code, f"“{code}”" if code else "no answer")


def _undecided(event: Record) -> str:
    """Return why the advisor did not decide; "" if it did."""
    failure = str(event.get("failure", ""))
    return f"Not decided by the advisor: {_describe_failure(failure)}." if failure else ""


def _numbers(values: list[float], digits: int) -> str:
    return ", ".join(f"{round(value, digits) + 0.0:.{digits}f}" for value in values)
