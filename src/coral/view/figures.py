"""The charts of a run report: coverage, motion, events, control time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

import numpy as np

from coral.view.decisions import Decision
from coral.view.run import Record, RunFolder
from coral.view.svg import LEFT, RIGHT, WIDTH, Span, chart, clock, line, path, text, thin, time_axis

ROBOT_RADIUS_M = 0.3
"""Radius of the disc for collisions (CORAL IV-F)."""


def coverage_chart(run: RunFolder) -> str:
    """Draw the share of true clusters covered over time, each cluster named at the time of its coverage."""
    axis = time_axis(run.duration_s)
    top, bottom = 26.0, 196.0
    y = Span(0.0, 1.0, bottom, top)
    body = []
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        body += [
            line(axis.start_px, y(share), axis.end_px, y(share), "grid"),
            text(LEFT - 8, y(share) + 4, f"{share:.0%}", "tick", "end"),
        ]
    times, coverage = run.column("t"), run.column("coverage")
    if len(times):
        t = np.concatenate([[0.0], times])
        c = np.concatenate([[0.0 if math.isnan(coverage[0]) else coverage[0]], coverage])
        change = np.concatenate([[True], np.diff(c) != 0])
        change[-1] = True
        xs, ys = [axis(float(v)) for v in t[change]], [y(float(v)) for v in c[change]]
        curve = path(xs, ys, "curve good", steps=True)
        area = curve.split('"')[1] + f"L{xs[-1]:.1f},{bottom:.1f}L{xs[0]:.1f},{bottom:.1f}Z"
        body += [f'<path d="{area}" class="area good"/>', curve]
        used = [-math.inf] * 3
        for event in run.select("cluster_covered"):
            at = float(event["t"])
            level = y(float(np.interp(at + 0.15, t, c)))
            x = axis(at)
            row = next((k for k, end in enumerate(used) if x > end + 4), 0)
            name = str(event.get("name", ""))
            used[row] = x + 7.0 * len(name) + 10
            body += [
                f'<circle cx="{x:.1f}" cy="{level:.1f}" r="4.5" class="dot good"><title>'
                f"{escape(name)} covered at {clock(at)}</title></circle>",
                text(
                    min(x + 8, axis.end_px - 20),
                    level + 16 + 14 * row if level < 150 else level - 8 - 13 * row,
                    name,
                    "mark",
                    "start",
                ),
            ]
    body.append(text(LEFT - 68, (top + bottom) / 2, "clusters", "name rot"))
    return chart(224, body, axis, label="Coverage over time", top=top, bottom=bottom)


def speed_chart(run: RunFolder) -> str:
    """Draw the forward speed, actual and commanded."""
    axis = time_axis(run.duration_s)
    t, u, v, command = run.column("t"), run.column("u"), run.column("v"), run.column("v_cmd")
    speed = np.hypot(u, v)
    highest = max([0.2] + [float(np.nanmax(a)) for a in (speed, command) if len(a) and np.isfinite(a).any()])
    top, bottom = 24.0, 150.0
    y = Span(0.0, math.ceil(highest * 10 + 0.2) / 10, bottom, top)
    body = [
        part
        for value in y.ticks(4)
        for part in (
            line(axis.start_px, y(value), axis.end_px, y(value), "grid"),
            text(LEFT - 8, y(value) + 4, f"{value:g}", "tick", "end"),
        )
    ]
    for values, cls in ((command, "curve faint"), (speed, "curve main")):
        times, kept = thin(t, values)
        body.append(path([axis(float(a)) for a in times], [y(float(b)) for b in np.clip(kept, 0, y.high)], cls))
    body += [
        text(LEFT - 68, (top + bottom) / 2, "speed, m/s", "name rot"),
        text(axis.end_px, top - 8, "actual", "key main", "end"),
        text(axis.end_px - 54, top - 8, "commanded", "key faint", "end"),
    ]
    return chart(176, body, axis, label="Speed over time", top=top, bottom=bottom)


def clearance_chart(run: RunFolder) -> str:
    """Draw the true distance from the robot's hull to the nearest obstacle; zero is contact."""
    axis = time_axis(run.duration_s)
    t, clearance = run.column("t"), run.column("clearance")
    top, bottom = 24.0, 180.0
    lowest = float(np.nanmin(clearance)) if np.isfinite(clearance).any() else 0.0
    y = Span(min(0.0, math.floor(lowest * 10) / 10), 2.0, bottom, top)
    body = [
        f'<rect x="{LEFT}" y="{y(ROBOT_RADIUS_M):.1f}" width="{axis.end_px - LEFT:.1f}" '
        f'height="{y(0) - y(ROBOT_RADIUS_M):.1f}" class="band"/>'
    ]
    body += [
        part
        for value in (0.0, 0.5, 1.0, 1.5, 2.0)
        for part in (
            line(axis.start_px, y(value), axis.end_px, y(value), "grid"),
            text(LEFT - 8, y(value) + 4, f"{value:g}" + ("+" if value == 2 else ""), "tick", "end"),
        )
    ]
    times, kept = thin(t, np.minimum(clearance, 2.0))
    body += [
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
    for event in run.select("collision", "robot_collision", "planner_failure", "fallback", "monitor"):
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
    "robot_collision": "two robots touched",
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


def control_histogram(timing: Record) -> str:
    """Draw the wall time of control ticks on a logarithmic count axis; "" without data."""
    histogram = timing.get("control_ms_histogram")
    if not isinstance(histogram, dict):
        return ""
    counts = [int(c) for c in histogram.get("counts") or ()]
    edges = [float(e) for e in histogram.get("edges") or ()]
    if not sum(counts) or len(edges) != len(counts) + 1:
        return ""
    last = max(k for k, count in enumerate(counts) if count) + 1
    width = edges[1] - edges[0]
    x = Span(0.0, edges[max(last, 4) - 1] + width if len(edges) > 4 else edges[-1], LEFT, WIDTH - RIGHT)
    top, bottom = 12.0, 150.0
    decades = max(1, math.ceil(math.log10(max(counts) + 1)))
    y = Span(-0.3, decades, bottom, top)
    body = [
        part
        for k in range(decades + 1)
        for part in (
            line(LEFT, y(k), WIDTH - RIGHT, y(k), "grid"),
            text(LEFT - 8, y(k) + 4, f"{10**k:,}", "tick", "end"),
        )
    ]
    for k, count in enumerate(counts[:last]):
        if count:
            height = bottom - y(math.log10(count))
            body.append(
                f'<rect x="{x(edges[k]) + 0.5:.1f}" y="{bottom - height:.1f}" '
                f'width="{max(1.0, x(edges[k] + width) - x(edges[k]) - 1):.1f}" height="{height:.1f}" class="bar">'
                f"<title>{edges[k]:.2f}–{edges[k + 1]:.2f} ms: {count} ticks</title></rect>"
            )
    if edges[last] - edges[last - 1] > 1.5 * width:
        body.append(text(x.end_px, bottom - 10 - height, f"up to {edges[last]:.0f} ms", "mark", "end"))
    for key, name in (("control_ms_median", "median"), ("control_ms_p99", "99th percentile")):
        value = timing.get(key)
        if isinstance(value, int | float) and value <= x.high:
            right = x(value) > WIDTH - 200
            body += [
                line(x(value), top, x(value), bottom, "limit main"),
                text(
                    x(value) + (-6 if right else 6),
                    top + 10 + (14 if key.endswith("p99") else 0),
                    f"{name} {value:.2f} ms",
                    "mark",
                    "end" if right else "start",
                ),
            ]
    body += [text(x(v), bottom + 18, f"{v:g}", "tick") for v in x.ticks(10)]
    body += [
        text(WIDTH - RIGHT, bottom + 34, "milliseconds per control tick", "tick", "end"),
        text(LEFT - 68, (top + bottom) / 2, "ticks", "name rot"),
        line(LEFT, bottom, WIDTH - RIGHT, bottom, "axis"),
    ]
    return (
        f'<svg viewBox="0 0 {WIDTH:.0f} 190" class="chart" role="img" aria-label="Control time histogram">'
        f"{''.join(body)}</svg>"
    )
