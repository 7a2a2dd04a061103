"""The charts of a run report: what was seen by when, motion, events."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from html import escape

import numpy as np

from coral.run_files import SurveyFiles
from coral.view.curves import curves_chart
from coral.view.decisions import Decision
from coral.view.run import Record, RunFolder, read_table
from coral.view.svg import LEFT, Floats, Span, chart, clock, levels, line, path, text, thin, time_axis

ROBOT_RADIUS_M = 0.3
"""Radius of the disc for collisions (CORAL IV-F)."""
INSPECTED_MARKS = (0.5, 0.8, 0.9, 1.0)
"""Shares whose times are marked on the curve of the inspected area."""


def coverage_chart(run: RunFolder) -> str:
    """Draw the share of true clusters covered over time, with a dot for each cluster."""
    times, coverage = run.column("t"), run.column("coverage")
    marks = []
    if len(times):
        times = np.concatenate([[0.0], times])
        coverage = np.concatenate([[0.0 if math.isnan(coverage[0]) else coverage[0]], coverage])
        for event in run.select("cluster_covered"):
            at = float(event["t"])
            level = float(np.interp(at + 0.15, times, coverage))
            marks.append((at, level, f"{event.get('name', '')} covered at {clock(at)}"))
    return _shares_chart(run, "Coverage over time", "clusters", {"covered": (times, coverage)}, marks)


def imaging_chart(run: RunFolder) -> str:
    """Draw the shares of the oyster area that were imaged and inspected over time; "" for a run without them."""
    table = read_table(run.path / SurveyFiles.JUDGE)
    if not {"t", "imaged", "inspected"} <= table.keys() or not len(table["t"]):
        return ""
    t, inspected = table["t"], table["inspected"]
    marks = []
    for share in INSPECTED_MARKS:
        reached = np.flatnonzero(inspected >= share - 1e-6)
        if reached.size:
            at = float(t[reached[0]])
            marks.append((at, share, f"{share:.0%} inspected at {clock(at)}"))
    curves = {"imaged": (t, table["imaged"]), "inspected": (t, inspected)}
    return _shares_chart(run, "Imaged and inspected over time", "oyster area", curves, marks)


def _shares_chart(
    run: RunFolder,
    label: str,
    of: str,
    curves: Mapping[str, tuple[Floats, Floats]],
    marks: Sequence[tuple[float, float, str]],
) -> str:
    """Draw shares over time as steps.

    Args:
        run: The run.
        label: Label for screen readers.
        of: What they are shares of.
        curves: Times (s) and shares by name; the last one is drawn strongest, and its last value is told.
        marks: Time (s), share and text of dots.
    """
    axis = time_axis(run.duration_s)
    top, bottom = 26.0, 196.0
    y = Span(0.0, 1.0, bottom, top)
    body = levels(axis, y, {share: f"{share:.0%}" for share in (0.0, 0.25, 0.5, 0.75, 1.0)})
    key_px = axis.end_px
    for number, (name, (t, values)) in enumerate(reversed(list(curves.items()))):
        cls = "faint" if number else "main"
        told = name if number or not len(values) or not math.isfinite(values[-1]) else f"{name} {values[-1]:.0%}"
        changed = np.concatenate([[True], np.diff(values) != 0.0]) if len(values) else np.zeros(0, bool)
        changed[-1:] = True
        body.append(path([axis(v) for v in t[changed]], [y(v) for v in values[changed]], f"curve {cls}", steps=True))
        body.append(text(key_px, top - 8, told, f"key {cls}", "end"))
        key_px -= 7.2 * len(told) + 24
    body += [
        f'<circle cx="{axis(at):.1f}" cy="{y(share):.1f}" r="4.5" class="dot main">'
        f"<title>{escape(said)}</title></circle>"
        for at, share, said in marks
    ]
    body.append(text(LEFT - 68, (top + bottom) / 2, of, "name rot"))
    return chart(224, body, axis, label=label, top=top, bottom=bottom)


def speed_chart(run: RunFolder) -> str:
    """Draw the speed over ground, and the forward speed that was commanded."""
    speed = np.hypot(run.column("u"), run.column("v"))
    curves = {"actual": speed, "commanded": run.column("v_cmd")}
    return curves_chart(run.duration_s, run.column("t"), curves, "speed, m/s", height=176.0, floor=0.0)


def clearance_chart(run: RunFolder) -> str:
    """Draw the true distance from the robot's hull to the nearest obstacle; zero is contact."""
    axis = time_axis(run.duration_s)
    t, clearance = run.column("t"), run.column("clearance")
    top, bottom = 24.0, 180.0
    lowest = float(np.nanmin(clearance)) if np.isfinite(clearance).any() else 0.0
    y = Span(min(0.0, math.floor(lowest * 10) / 10), 2.0, bottom, top)
    times, kept = thin(t, np.minimum(clearance, 2.0))
    body = [
        f'<rect x="{LEFT}" y="{y(ROBOT_RADIUS_M):.1f}" width="{axis.end_px - LEFT:.1f}" '
        f'height="{y(0) - y(ROBOT_RADIUS_M):.1f}" class="band"/>',
        *levels(axis, y, {0.0: "0", 0.5: "0.5", 1.0: "1", 1.5: "1.5", 2.0: "2+"}),
        path([axis(float(a)) for a in times], [y(float(b)) for b in kept], "curve main"),
        line(axis.start_px, y(0.0), axis.end_px, y(0.0), "limit"),
        text(LEFT - 68, (top + bottom) / 2, "clearance, m", "name rot"),
    ]
    if np.isfinite(clearance).any():
        k = int(np.nanargmin(clearance))
        x, low = axis(float(t[k])), y(min(2.0, lowest))
        body += [
            f'<circle cx="{x:.1f}" cy="{low:.1f}" r="4.5" class="dot main"/>',
            text(axis.end_px, top - 9, f"closest pass {lowest:.2f} m at {clock(float(t[k]))}", "key main", "end"),
        ]
    for event in (e for e in run.select("collision") if not e.get("robot")):
        x = axis(float(event["t"]))
        body.append(f'<path d="M{x - 5:.1f},{y(0) - 5:.1f}l10,10m0,-10l-10,10" class="cross"/>')
    return chart(208, body, axis, label="Clearance over time", top=top, bottom=bottom)


LANES = (
    ("first", "first question"),
    ("distance", "near the goal"),
    ("stuck", "stuck"),
    ("failure", "planner failed"),
    ("deviation", "off the path"),
    ("own", "own trigger"),
    ("instruction", "new instruction"),
)


def event_chart(run: RunFolder, made: Sequence[Decision]) -> str:
    """Draw when and why the advisor was or was not asked, its latency, and its mode."""
    axis = time_axis(run.duration_s)
    triggers = run.select("trigger")
    causes = {str(event.get("cause")) for event in triggers}
    lanes = [(key, name) for key, name in LANES if key in causes]
    lanes += [(cause, cause) for cause in sorted(causes - {key for key, _ in LANES})]
    rows = [name for _, name in lanes] + ["advisor thinking", "mode", "incidents"]
    top, pitch = 12.0, 28.0
    bottom = top + pitch * len(rows)
    middle = {name: top + pitch * (k + 0.5) for k, name in enumerate(rows)}
    body = [
        part
        for name in rows
        for part in (
            line(axis.start_px, middle[name], axis.end_px, middle[name], "lane"),
            text(LEFT - 8, middle[name] + 4, name, "tick", "end"),
        )
    ]
    for cause, name in lanes:
        held: dict[str, list[float]] = {}
        for event in triggers:
            if event.get("cause") == cause and not event.get("fired"):
                held.setdefault(str(event.get("held_by") or "held"), []).append(float(event["t"]))
        for why, times in held.items():
            for start, end in _stretches(times):
                x, width = axis(start), max(3.0, axis(end) - axis(start))
                body.append(
                    f'<rect x="{x:.1f}" y="{middle[name] - 4:.1f}" width="{width:.1f}" height="8" '
                    f'class="held {escape(why)}"><title>{clock(start)}–{clock(end)}: held back '
                    f"({escape(HELD.get(why, why))})</title></rect>"
                )
        for event in triggers:
            if event.get("cause") == cause and event.get("fired"):
                body.append(
                    f'<circle cx="{axis(float(event["t"])):.1f}" cy="{middle[name]:.1f}" r="5.5" '
                    f'class="fired"><title>{clock(float(event["t"]))}: asked ({escape(name)})</title></circle>'
                )
    for decision in made:
        for one in decision.tries:
            end = one.answered_at_s if one.answered_at_s is not None else run.duration_s
            x, width = axis(one.asked_at_s), max(2.0, axis(end) - axis(one.asked_at_s) - 1)
            body.append(
                f'<rect x="{x:.1f}" y="{middle["advisor thinking"] - 8:.1f}" width="{width:.1f}" height="16" '
                f'rx="2" class="ask {escape(one.verdict)}" data-decision="{decision.number}"><title>decision '
                f"{decision.number}, {escape(one.verdict)} {escape(one.code)}</title></rect>"
            )
    body += _mode_bars([e for e in run.select("mode") if not e.get("robot")], axis, run.duration_s, middle["mode"])
    for event in run.select("collision", "planner_failure", "fallback", "monitor"):
        x, y0, kind = axis(float(event["t"])), middle["incidents"], str(event["event"])
        body.append(
            f'<rect x="{x - 2:.1f}" y="{y0 - 8:.1f}" width="4" height="16" class="incident {kind}"><title>'
            f"{clock(float(event['t']))}: {INCIDENTS[kind]}</title></rect>"
        )
    return chart(bottom + 26, body, axis, label="Triggers and decisions over time", top=top, bottom=bottom)


HELD = {
    "pending": "a question was already open",
    "cooldown": "asked too recently",
    "separation": "the new goal would be too near the old one",
}
INCIDENTS = {
    "collision": "collision",
    "planner_failure": "no safe motion found, robot brakes",
    "fallback": "the advisor did not decide, the fallback did",
    "monitor": "left the planned path, planned anew",
}


def _stretches(times: Sequence[float], gap: float = 0.35) -> list[tuple[float, float]]:
    """Join consecutive ticks to intervals."""
    joined: list[tuple[float, float]] = []
    for t in times:
        if joined and t - joined[-1][1] <= gap:
            joined[-1] = (joined[-1][0], t)
        else:
            joined.append((t, t))
    return joined


def _mode_bars(modes: Sequence[Record], axis: Span, end_s: float, y: float) -> list[str]:
    bars = []
    for k, event in enumerate(modes):
        start = float(event["t"])
        end = float(modes[k + 1]["t"]) if k + 1 < len(modes) else end_s
        mode, x, width = str(event.get("mode", "")), axis(start), axis(end) - axis(start)
        bars.append(
            f'<rect x="{x:.1f}" y="{y - 8:.1f}" width="{max(1.0, width):.1f}" height="16" '
            f'class="mode {escape(mode)}"><title>{clock(start)}–{clock(end)}: {escape(mode)}</title></rect>'
        )
        if width > 8.0 * len(mode):
            bars.append(text(x + 6, y + 4, mode, "inbar", "start"))
    return bars
