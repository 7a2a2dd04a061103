"""The events of a reef mission, reduced to the state that a viewer needs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from coral.view.decisions import Try
from coral.view.live.state import Answered, Asked
from coral.view.run import Record
from coral.view.svg import clock

TITLES = {"centroid": "Which cluster next?", "waypoint": "Where to next?"}
CAUSES = {
    "distance": "the goal is near",
    "stuck": "the robot is stuck",
    "failure": "the planner found no way",
    "deviation": "the robot left its path",
    "first": "the mission began",
    "own": "the user's own trigger fired",
}
KEPT = 6
"""Number of lines in the log."""


@dataclass(frozen=True, kw_only=True)
class Story:
    """The mission's history so far."""

    asked: Asked | None = None
    answered: Answered | None = None
    calls: int = 0
    requeries: int = 0
    collisions: int = 0
    covered: int = 0
    clusters: int = 0
    ended: str = ""
    state: str = ""
    """State of the vehicle; of several robots, that of the last one that changed it."""
    cause: str = ""
    log: tuple[str, ...] = ()
    """Lines of the log, newest first."""


def told(story: Story, event: Record) -> Story:
    """Return the story after one more event of `events.jsonl`; events that a viewer does not need change nothing."""
    fold = _FOLDS.get(str(event.get("event")))
    return story if fold is None else fold(story, event)


def _start(story: Story, event: Record) -> Story:
    return note(replace(story, clusters=int(event.get("clusters_total") or 0)), event, "the mission begins")


def _trigger(story: Story, event: Record) -> Story:
    return replace(story, cause=str(event.get("cause", ""))) if event.get("fired") else story


def _question(story: Story, event: Record) -> Story:
    mode, attempt = str(event.get("mode", "")), int(event.get("attempt") or 0)
    asked = Asked(
        title=TITLES.get(mode, mode),
        mode=mode,
        since_s=float(event["t"]),
        attempt=attempt,
        cause=CAUSES.get(story.cause, story.cause),
    )
    again = f", attempt {attempt + 1}" if attempt else ""
    return note(
        replace(story, asked=asked, calls=story.calls + 1, requeries=story.requeries + (attempt > 0)),
        event,
        f"asked: {asked.title}{again}",
    )


def _verdict(story: Story, event: Record) -> Story:
    answer = event.get("answer")
    heard = Try(
        attempt=0,
        asked_at_s=0.0,
        answered_at_s=0.0,
        verdict=str(event.get("verdict", "")),
        answer=answer if isinstance(answer, dict) else {"answer": answer} if answer else {},
    )
    reason = str(event.get("reason") or "") or heard.why
    answered = Answered(verdict=heard.verdict, said=heard.said, at_s=float(event["t"]), reason=reason)
    return note(replace(story, asked=None, answered=answered), event, f"{heard.verdict}: {heard.said}")


def _goal(story: Story, event: Record) -> Story:
    if event.get("source") in ("advisor", "recording"):
        return story
    source = "the rules" if event.get("source") == "fallback" else "the start"
    return note(story, event, f"new goal, chosen by {source}")


def _covered(story: Story, event: Record) -> Story:
    return note(replace(story, covered=story.covered + 1), event, f"covered {event.get('name', 'a cluster')}")


def _collision(story: Story, event: Record) -> Story:
    return note(replace(story, collisions=story.collisions + 1), event, "collision")


def _end(story: Story, event: Record) -> Story:
    reason = str(event.get("reason", ""))
    return note(replace(story, asked=None, ended=reason), event, f"ended: {reason}")


def _state(story: Story, event: Record) -> Story:
    state, reason = str(event.get("state", "")), str(event.get("reason", ""))
    return note(replace(story, state=state), event, f"{state}: {reason}")


def _sensor(story: Story, event: Record) -> Story:
    refused = event.get("refused")
    return note(story, event, f"{event.get('input', 'sensor')} {refused or 'is good again'}")


def _alignment(story: Story, event: Record) -> Story:
    """Tell what became of a resumed survey's search for its place."""
    evidence = f"{event.get('matched')} of {event.get('bodies')} bodies match, residual {event.get('residual_m')} m"
    said = {
        "proposed": f"alignment proposed: {evidence}",
        "used": f"on the saved map: {evidence}",
        "none yet": f"no place on the saved map yet: {event.get('reason', '')}",
        "unaligned": f"goes on without the saved map: {event.get('reason', '')}",
    }
    return note(story, event, said.get(str(event.get("status")), "alignment"))


def note(story: Story, event: Record, text: str) -> Story:
    """Add a line to the log, unless it is the last one again: a lasting failure is reported at every tick."""
    if story.log and story.log[0].partition(" ")[2] == text:
        return story
    return replace(story, log=(f"{clock(float(event['t']))} {text}", *story.log)[:KEPT])


_FOLDS: dict[str, Callable[[Story, Record], Story]] = {
    "start": _start,
    "trigger": _trigger,
    "question": _question,
    "verdict": _verdict,
    "goal": _goal,
    "cluster_covered": _covered,
    "collision": _collision,
    "robot_collision": _collision,
    "end": _end,
    "state": _state,
    "sensor": _sensor,
    "alignment": _alignment,
    "planner_failure": lambda s, e: note(s, e, f"no way found: {e.get('reason', '')}"),
    "held": lambda s, e: note(s, e, "the goal is kept"),
    "fallback": lambda s, e: note(s, e, f"the advisor failed ({e.get('failure', '')})"),
    "monitor": lambda s, e: note(s, e, "left the planned path, planned again"),
}
