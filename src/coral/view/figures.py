"""The charts of a run report: what was seen by when, motion, events."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from coral.run_files import SurveyFiles
from coral.view.charts import HUES, bar, curves_chart, dot, lanes_chart, svg
from coral.view.decisions import CAUSES, Decision
from coral.view.run import RunFolder, read_table
from coral.words import clock

ROBOT_RADIUS_M = 0.3
"""Radius of the disc for collisions (CORAL IV-F)."""
INSPECTED_MARKS = (0.5, 0.8, 0.9, 1.0)
"""Shares whose times are marked on the curve of the inspected area."""
FARTHEST_M = 2.0
"""Largest clearance that is drawn."""


def coverage_chart(run: RunFolder) -> str:
    """Draw the share of true clusters covered over time, with a dot for each cluster."""
    times, coverage = run.column("t"), run.column("coverage")
    if len(times):
        times = np.concatenate([[0.0], times])
        coverage = np.concatenate([[0.0 if math.isnan(coverage[0]) else coverage[0]], coverage])
    name = f"covered {coverage[-1]:.0%}" if len(coverage) and math.isfinite(coverage[-1]) else "covered"
    axes = curves_chart(run.duration_s, times, {name: coverage}, "clusters covered")
    for event in run.select("cluster_covered") if len(times) else ():
        at = float(event["t"])
        level = float(np.interp(at + 0.15, times, coverage))
        dot(axes, at, level, f"{event.get('name', '')} covered at {clock(at)}")
    return _shares(axes)


def imaging_chart(run: RunFolder) -> str:
    """Draw the shares of the oyster area that were imaged and inspected over time; "" for a run without them."""
    table = read_table(run.path / SurveyFiles.JUDGE)
    if not {"t", "imaged", "inspected"} <= table.keys() or not len(table["t"]):
        return ""
    t, imaged, inspected = table["t"], table["imaged"], table["inspected"]
    curves = {f"inspected {inspected[-1]:.0%}": inspected, f"imaged {imaged[-1]:.0%}": imaged}
    axes = curves_chart(run.duration_s, t, curves, "oyster area")
    for share in INSPECTED_MARKS:
        reached = np.flatnonzero(inspected >= share - 1e-6)
        if reached.size:
            at = float(t[reached[0]])
            dot(axes, at, share, f"{share:.0%} inspected at {clock(at)}")
    return _shares(axes)


def _shares(axes: Axes) -> str:
    """Finish a chart of shares, each of which holds until the next."""
    for line in axes.lines:
        line.set_drawstyle("steps-post")
    axes.set(ylim=(0, 1), yticks=[0, 0.25, 0.5, 0.75, 1], yticklabels=["0%", "25%", "50%", "75%", "100%"])
    return svg(axes)


def speed_chart(run: RunFolder) -> str:
    """Draw the speed over ground, and the forward speed that was commanded."""
    curves = {"actual": np.hypot(run.column("u"), run.column("v")), "commanded": run.column("v_cmd")}
    return svg(curves_chart(run.duration_s, run.column("t"), curves, "speed, m/s", 118.0))


def clearance_chart(run: RunFolder) -> str:
    """Draw the true distance from the robot's hull to the nearest obstacle; zero is contact."""
    t, clearance = run.column("t"), run.column("clearance")
    dots = [
        (float(event["t"]), 0.0, f"collision at {clock(float(event['t']))}")
        for event in run.select("collision")
        if not event.get("robot")
    ]
    name = "clearance"
    if np.isfinite(clearance).any():
        k = int(np.nanargmin(clearance))
        name = f"clearance: closest pass {clearance[k]:.2f} m at {clock(float(t[k]))}"
        dots.append((float(t[k]), min(FARTHEST_M, float(clearance[k])), name))
    axes = curves_chart(run.duration_s, t, {name: np.minimum(clearance, FARTHEST_M)}, "clearance, m")
    axes.axhspan(0.0, ROBOT_RADIUS_M, color=HUES[1], alpha=0.07)
    axes.axhline(0.0, color=HUES[1], linewidth=1.5)
    for at, value, told in dots:
        dot(axes, at, value, told)
    axes.set_ylim(top=FARTHEST_M)
    axes.set_yticks([0.0, 0.5, 1.0, 1.5, FARTHEST_M], ["0", "0.5", "1", "1.5", "2+"])
    return svg(axes)


HELD = {
    "pending": ("a question was already open", "#c9d1d9"),
    "cooldown": ("asked too recently", "#e9b44c"),
    "separation": ("the new goal would be too near the old one", "#b79be0"),
}
ASKED = {
    "accepted": ("accepted", "#4fae7c"),
    "rejected": ("rejected", "#e0796f"),
    "malformed": ("malformed or no answer", "#b8433a"),
    "unavailable": ("malformed or no answer", "#b8433a"),
}
MODES = {"centroid": "#ffdcb3", "waypoint": "#cfdcf5"}
INCIDENTS = {
    "collision": "collision",
    "planner_failure": "no safe motion found, robot brakes",
    "fallback": "the advisor did not decide, the fallback did",
    "monitor": "left the planned path, planned anew",
}


def event_chart(run: RunFolder, made: Sequence[Decision]) -> str:
    """Draw when and why the advisor was or was not asked, its latency, and its mode."""
    triggers = run.select("trigger")
    causes = {str(event.get("cause")) for event in triggers}
    lanes = [*(key for key in CAUSES if key in causes), *sorted(causes - CAUSES.keys())]
    rows = [*(CAUSES.get(key, key) for key in lanes), "advisor thinking", "mode", "incidents"]
    thinking, mode_lane, incidents = range(len(lanes), len(rows))
    axes = lanes_chart(run.duration_s, rows, "Triggers and decisions over time")
    held: dict[tuple[int, str], list[float]] = {}
    for event in triggers:
        lane, t = lanes.index(str(event.get("cause"))), float(event["t"])
        if event.get("fired"):
            dot(axes, t, lane, f"{clock(t)}: asked ({rows[lane]})", 11, label="fired")
        else:
            held.setdefault((lane, str(event.get("held_by") or "held")), []).append(t)
    for (lane, why), times in held.items():
        words, color = HELD.get(why, (why, "#c9d1d9"))
        for start, end in _stretches(times):
            said = f"{clock(start)}–{clock(end)}: held back ({words})"
            bar(axes, lane, start, end, said, color, 8, label=f"held back: {words}")
    for decision in made:
        for one in decision.tries:
            end = one.answered_at_s if one.answered_at_s is not None else run.duration_s
            words, color = ASKED.get(one.verdict, ("withdrawn or still open", "#9aa7b4"))
            said, number = f"decision {decision.number}, {one.verdict} {one.code}", decision.number
            bar(axes, thinking, one.asked_at_s, end, said, color, label=words, decision=number, edgecolor="white")
    modes = [event for event in run.select("mode") if not event.get("robot")]
    ends = [*(float(event["t"]) for event in modes[1:]), run.duration_s]
    for event, end in zip(modes, ends, strict=False):
        start, mode = float(event["t"]), str(event.get("mode", ""))
        said = f"{clock(start)}–{clock(end)}: {mode}"
        bar(axes, mode_lane, start, end, said, MODES.get(mode, "#dfe9ec"), name=mode)
    for event in run.select(*INCIDENTS):
        t, kind = float(event["t"]), str(event["event"])
        color = HUES[1] if kind == "collision" else HUES[2]
        bar(axes, incidents, t, t, f"{clock(t)}: {INCIDENTS[kind]}", color, label="incident")
    return svg(axes)


def _stretches(times: Sequence[float], gap: float = 0.35) -> list[tuple[float, float]]:
    joined: list[tuple[float, float]] = []
    for t in times:
        if joined and t - joined[-1][1] <= gap:
            joined[-1] = (joined[-1][0], t)
        else:
            joined.append((t, t))
    return joined
