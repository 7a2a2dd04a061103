"""The events of a contact episode, reduced to what a viewer reads."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from coral.view.live.story import Story, note
from coral.view.run import Record

KINDS = {
    "physical-parameters": "masses and frictions",
    "cost-function": "the plan",
    "contact-regions": "where to touch",
    "parameter-repair": "corrected masses and frictions",
    "cost-repair": "a repaired plan",
}


def told_of_task(story: Story, event: Record) -> Story:
    """Return the story after one more event of `events.jsonl`; events that a viewer does not need change nothing."""
    fold = _FOLDS.get(str(event.get("event")))
    return story if fold is None else fold(story, event)


def _verdict(story: Story, event: Record) -> Story:
    kind = str(event.get("kind", ""))
    code = str(event.get("code") or "")
    what = KINDS.get(kind, kind)
    return note(
        replace(story, calls=story.calls + 1), event, f"{event.get('verdict')}: {what}{f' ({code})' if code else ''}"
    )


def _stuck(story: Story, event: Record) -> Story:
    return note(story, event, f"stuck in “{event.get('stage')}”: {event.get('text')}")


def _track(story: Story, event: Record) -> Story:
    name = event.get("object")
    return note(story, event, f"{name} lost: {event.get('reason')}" if event.get("lost") else f"{name} found again")


def _contact(story: Story, event: Record) -> Story:
    pair = {str(event.get("first")), str(event.get("second"))}
    return (
        note(story, event, f"{' touches '.join(sorted(pair))}")
        if event.get("step", 1) and "table" not in pair
        else story
    )


def _end(story: Story, event: Record) -> Story:
    reason = str(event.get("reason", ""))
    detail = f" ({event['detail']})" if event.get("detail") else ""
    return note(replace(story, asked=None, ended=reason), event, f"ended: {reason}{detail}")


_FOLDS: dict[str, Callable[[Story, Record], Story]] = {
    "start": lambda s, e: note(s, e, f"the task: {e.get('instruction', '')}"),
    "verdict": _verdict,
    "strategy": lambda s, e: note(s, e, f"follows “{e.get('name')}”"),
    "stage": lambda s, e: note(replace(s, state=str(e.get("stage"))), e, f"stage “{e.get('stage')}”"),
    "stuck": _stuck,
    "correction": lambda s, e: note(s, e, f"correction: {e.get('text', '')}"),
    "fallback": lambda s, e: note(s, e, f"the advisor did not decide on the {e.get('what', '')}"),
    "weight": lambda s, e: note(s, e, f"operator: {e.get('factor')} × “{e.get('term')}” in “{e.get('stage')}”"),
    "track": _track,
    "contact": _contact,
    "end": _end,
}
