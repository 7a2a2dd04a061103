"""The report of a contact episode: one self-contained page."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup

from coral.advisor.attribution import who_decided
from coral.contact.episode.metrics import DEFINITIONS, metrics_of
from coral.contact.episode.trial_log import END_REASONS
from coral.contact.scene.trial import Trial
from coral.drawing import Image, contact_sheet, png, webp_url
from coral.errors import InputError, RunError
from coral.file_writer import write_whole, writing
from coral.run_files import TaskFiles
from coral.view.contact.figures import (
    cost_chart,
    force_chart,
    motion_chart,
    opening_chart,
    samples_chart,
    stage_spans,
    stages_chart,
    touching,
    tracking_chart,
    tracks,
    wanted_forces,
)
from coral.view.contact.replay import ReplayedScene, trial_of_run
from coral.view.contact.thought import answers, counted, seen, thoughts
from coral.view.page import metric_rows, origin, render_page, write_page
from coral.view.run import Record, RunFolder

SIZE = (400, 300)
FEWEST, MOST = 8, 12
COLUMNS = 4


def write_contact_report(run_folder: str | Path) -> Path:
    """Write `report.html` and, if states were kept, `keyframes.png` into a run folder; return the page's path.

    The page contains its pictures and styles and loads nothing from elsewhere. Existing files are replaced.

    Raises:
        InputError: There is no run in the folder, or a file cannot be written.
    """
    run = RunFolder.read(run_folder)
    notes = list(run.notes)
    frames: list[Keyframe] = []
    if (run.path / TaskFiles.STATES).is_file():
        try:
            frames = keyframes(run)
        except (InputError, RunError) as error:
            notes.append(f"No pictures: {error}")
    if frames:
        path = run.path / TaskFiles.KEYFRAMES
        with writing(path):
            write_whole(path, png(sheet(frames)))
    return write_page(run.path, render_contact_report(run, frames, notes))


def render_contact_report(run: RunFolder, frames: list[Keyframe], notes: list[str]) -> str:
    """Render the whole page as text."""
    try:
        trial: Trial | None = trial_of_run(run)
    except InputError as error:
        trial = None
        notes = [*notes, f"The task cannot be drawn again: {error}"]
    metrics = run.figures(metrics_of)
    objects = list(trial.objects) if trial is not None else []
    start: Record = (run.select("start") or [{}])[0]
    return render_page(
        "contact.html.j2",
        title=str(run.world.get("title") or start.get("task") or run.path.name),
        instruction=str(run.world.get("instruction", "")),
        headline=" ".join(filter(None, (_headline(run, metrics), _who_decided(run, metrics)))),
        complete=run.complete,
        duration=run.duration_s,
        tiles=_tiles(run, metrics),
        frames=[(f"{frame.t:.2f} s", frame.why, webp_url(frame.picture)) for frame in frames],
        thoughts=thoughts(run),
        answers=(given := answers(run)),
        counted=counted(given),
        seen=seen(run),
        charts=[(title, note, Markup(svg)) for title, note, svg in _charts(run, objects) if svg],
        contacts=[
            (
                f"{e['first']} – {e['second']}",
                *(f"{float(e[name]):.2f}" for name in ("begun_s", "ended_s")),
                *(f"{float(e[name]):.1f}" for name in ("mean_n", "peak_n")),
            )
            for e in touching(run)[:200]
        ],
        beliefs=_beliefs(run, start),
        rows=metric_rows(metrics, DEFINITIONS),
        **origin(run, ("task", "world", "variant", "advisor", "seed", "poses", "tracker"), tuple(run.timing)),
        notes=notes,
        video=(run.path / TaskFiles.VIDEO).is_file(),
    )


def _headline(run: RunFolder, metrics: Mapping[str, Any]) -> str:
    reason = str(metrics.get("end_reason", ""))
    detail = str((run.select("end") or [{}])[-1].get("detail", "")) or reason.partition(": ")[2]
    if not metrics.get("steps"):
        if reason in END_REASONS and reason != "killed":
            return f"Ended at the start: {END_REASONS[reason]}{f' ({detail})' if detail else ''}."
        return "Nothing was recorded yet."
    seconds, plans = float(metrics.get("sim_time_s", 0.0)), int(metrics.get("plans", 0))
    how = f"{plans} plans, {float(metrics.get('path_length_m', 0.0)):.2f} m of path"
    strategy = f"following “{metrics.get('strategy')}”" if metrics.get("strategy") else ""
    stage = (stage_spans(run) or [(0.0, 0.0, "")])[-1][2]
    if metrics.get("success"):
        return f"Done after {seconds:.1f} s of simulated time, {strategy}: {how}."
    if reason == "timeout":
        unmet = f" ({detail})" if detail else ""
        last = f"the last stage was “{stage}”: {how}."
        return f"Not done within {seconds:.0f} s of simulated time{unmet}, {strategy}; {last}"
    if not run.complete:
        return f"Cut off after {seconds:.1f} s of simulated time in stage “{stage}”, {strategy}: {how}."
    what = END_REASONS.get(reason.partition(":")[0], reason)
    return (
        f"Ended without success after {seconds:.1f} s of simulated time in stage “{stage}”, because {what}"
        f"{f' ({detail})' if detail else ''}: {how}."
    )


def _who_decided(run: RunFolder, metrics: Mapping[str, Any]) -> str:
    """Describe who decided, unless it was the advisor alone."""
    try:
        policy: str = run.config["episode"]["think"]["fallback"]
    except (KeyError, TypeError):
        policy = "prior"
    said = who_decided(metrics, things="decisions", fallback=policy, advisor="The advisor")
    return f"{said[0].upper()}{said[1:]}." if said else ""


def _tiles(run: RunFolder, metrics: Mapping[str, Any]) -> list[tuple[str, str, str, str]]:
    """Return (value, remark, name, state) of the key numbers."""
    if not metrics:
        return []
    success, reason = bool(metrics.get("success")), str(metrics.get("end_reason", ""))
    median = run.timing.get("plan_ms_median")
    mean, peak = metrics.get("mean_hand_force_n"), metrics.get("peak_hand_force_n", 0)
    wall = run.timing.get("wall_time_s")
    whole = float(metrics.get("time_with_thinking_s", 0.0))
    seconds = float(metrics.get("sim_time_s", 0))
    thinking = f", {whole:.1f} s with thinking" if whole > seconds else ""
    lasted = f"simulated{thinking}{f'; {wall:.0f} s on this machine' if wall else ''}"
    ended = ": ".join(filter(None, (END_REASONS.get(reason.partition(":")[0], reason), reason.partition(": ")[2])))
    who = metrics.get("judged_by", "truth")
    judged = "" if who == "truth" else f", judged by {who}"
    felt = "contacts are not measured" if peak is None else "no touch" if mean is None else f"mean {mean:.1f} N"
    return [
        ("yes" if success else "no", ended + judged, "success", "good" if success else "bad"),
        (f"{seconds:.1f} s", lasted, "time", ""),
        (str(metrics.get("plans", 0)), f"{median:.0f} ms each (median)" if median else "", "plans", ""),
        (str(metrics.get("stages", 0)), str(metrics.get("strategy", "")), "changes of stage", ""),
        ("unknown" if peak is None else f"{float(peak):.0f} N", felt, "largest force", ""),
        (str(metrics.get("advisor_calls", 0)), f"{metrics.get('repairs', 0)} repairs", "advisor calls", ""),
    ]


def _charts(run: RunFolder, objects: list[str]) -> list[tuple[str, str, str]]:
    if not len(run.column("t")):
        return []
    trial = [
        (
            "Stages and contacts",
            "The active stage of the strategy, and all contacts; “hand” is its palm, “left” and “right” are its "
            "fingers.",
            stages_chart(run),
        ),
        (
            "Force",
            "The hand’s net force on each object, and the force at the wrist, where a grasp’s squeeze cancels."
            f"{wanted_forces(run)}",
            force_chart(run, objects),
        ),
        ("Height above the table", "Height of the tool and of each object’s centre.", motion_chart(run, objects)),
        ("Fingers", "Distance between the finger pads.", opening_chart(run)),
    ]
    note = f"Distance of each tracked pose from the true one, modulo symmetry; no decision uses it. {tracks(run)}"
    trial.append(("Tracking", note, tracking_chart(run, objects)))
    if run.select("plan"):
        dashed = (
            "Expected value of each term over the horizon, at every plan; dashed: the stage changed, and with it the "
        )
        trial.insert(1, ("Cost, term by term", f"{dashed}terms.", cost_chart(run)))
        meaning = "How many of a plan's samples share its weight: at 1 the best one decides alone."
        trial.append(("Effective samples", meaning, samples_chart(run)))
    return trial


def _beliefs(run: RunFolder, start: Record) -> list[tuple[str, ...]]:
    """Return for each object: size, true mass, believed mass, true friction, believed friction."""
    truth = start.get("trial")
    held = [event["beliefs"] for event in run.select("strategy") if event.get("beliefs")]
    if not isinstance(truth, dict) or not held:
        return []
    rows: list[tuple[str, ...]] = []
    for name, item in truth.items():
        believed = held[-1][0].get(name, {})
        size = " × ".join(f"{100 * float(v):.1f}" for v in item["size_m"])
        masses = (f"{of.get('mass_kg', math.nan):.3f} kg" for of in (item, believed))
        frictions = (f"{of.get('friction', math.nan):.2f}" for of in (item, believed))
        rows.append((name, f"{size} cm", *masses, *frictions))
    return rows


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
