"""Key frames of an episode: its start, each change of stage or contact, and its end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coral.drawing import Image
from coral.view.contact.figures import stage_spans
from coral.view.contact.replay import ReplayedScene
from coral.view.contact_sheet import contact_sheet
from coral.view.run import RunFolder

SIZE = (400, 300)
FEWEST, MOST = 8, 12
COLUMNS = 4


@dataclass(frozen=True)
class Keyframe:
    """A moment and the reason for its selection."""

    t: float
    why: str
    picture: Image


def moments(run: RunFolder) -> list[tuple[float, str]]:
    """Choose times (s) with reasons, ascending: at most MOST; if little happened, the widest gaps are halved."""
    end = run.duration_s
    outcome = str(run.metrics.get("end_reason", "") or "end")
    found = [(0.0, "start"), (end, outcome)]
    found += [(start, f"begin to {name}") for start, _, name in stage_spans(run) if start > 0]
    ours = {"hand", "left", "right"}
    touched: set[str] = set()
    for event in run.select("contact"):
        pair = {str(event["first"]), str(event["second"])}
        for thing in sorted(pair - ours) if pair & ours else ():
            if thing not in touched:
                touched.add(thing)
                found.append((float(event["t"]), f"touches the {thing}"))
    gap = max(end / 40.0, 0.1)
    kept: list[tuple[float, str]] = []
    for t, why in found:  # by priority: start and end, then stages; later ones within `gap` are dropped
        if all(abs(t - other) >= gap for other, _ in kept) and len(kept) < MOST:
            kept.append((t, why))
    while len(kept) < FEWEST:
        times = sorted(t for t, _ in kept)
        widest = int(np.argmax(np.diff(times))) if len(times) > 1 else -1
        if widest < 0 or times[widest + 1] - times[widest] < 0.2:
            break
        kept.append(((times[widest] + times[widest + 1]) / 2, ""))
    return sorted(kept)


def keyframes(run: RunFolder) -> list[Keyframe]:
    """Draw the key frames of a run with recorded states.

    Raises:
        InputError: The run has no recorded states.
        RunError: Its world cannot be built on this machine.
    """
    scene = ReplayedScene(run, SIZE)
    return [Keyframe(t, why, scene.at(t)) for t, why in moments(run)]


def sheet(frames: list[Keyframe]) -> Image:
    """Combine the key frames into one picture."""
    return contact_sheet(
        [(f"{frame.t:.2f} s   {frame.why}", frame.picture) for frame in frames], min(COLUMNS, len(frames))
    )
