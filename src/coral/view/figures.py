"""The charts of a run report: what was seen by when, motion, events."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from coral.run_files import SurveyFiles
from coral.view.charts import Bar, clock, curves_chart, lanes_chart
from coral.view.decisions import Decision
from coral.view.run import RunFolder, read_table

ROBOT_RADIUS_M = 0.3
"""Radius of the disc for collisions (CORAL IV-F)."""
INSPECTED_MARKS = (0.5, 0.8, 0.9, 1.0)
"""Shares whose times are marked on the curve of the inspected area."""
PERCENT = {share: f"{share:.0%}" for share in (0.0, 0.25, 0.5, 0.75, 1.0)}
FARTHEST_M = 2.0
"""Largest clearance that is drawn."""


def coverage_chart(run: RunFolder) -> str:
    """Draw the share of true clusters covered over time, with a dot for each cluster."""
    times, coverage = run.column("t"), run.column("coverage")
    dots = []
    if len(times):
        times = np.concatenate([[0.0], times])
        coverage = np.concatenate([[0.0 if math.isnan(coverage[0]) else coverage[0]], coverage])
        for event in run.select("cluster_covered"):
            at = float(event["t"])
            level = float(np.interp(at + 0.15, times, coverage))
            dots.append((at, level, f"{event.get('name', '')} covered at {clock(at)}"))
    name = f"covered {coverage[-1]:.0%}" if len(coverage) and math.isfinite(coverage[-1]) else "covered"
    curves = {name: coverage}
    return curves_chart(
        run.duration_s, times, curves, "clusters covered", ceiling=1.0, ticks=PERCENT, dots=dots, steps=True
    )


def imaging_chart(run: RunFolder) -> str:
    """Draw the shares of the oyster area that were imaged and inspected over time; "" for a run without them."""
    table = read_table(run.path / SurveyFiles.JUDGE)
    if not {"t", "imaged", "inspected"} <= table.keys() or not len(table["t"]):
        return ""
    t, imaged, inspected = table["t"], table["imaged"], table["inspected"]
    dots = []
    for share in INSPECTED_MARKS:
        reached = np.flatnonzero(inspected >= share - 1e-6)
        if reached.size:
            at = float(t[reached[0]])
            dots.append((at, share, f"{share:.0%} inspected at {clock(at)}"))
    curves = {f"inspected {inspected[-1]:.0%}": inspected, f"imaged {imaged[-1]:.0%}": imaged}
    return curves_chart(run.duration_s, t, curves, "oyster area", ceiling=1.0, ticks=PERCENT, dots=dots, steps=True)


def speed_chart(run: RunFolder) -> str:
    """Draw the speed over ground, and the forward speed that was commanded."""
    speed = np.hypot(run.column("u"), run.column("v"))
    curves = {"actual": speed, "commanded": run.column("v_cmd")}
    return curves_chart(run.duration_s, run.column("t"), curves, "speed, m/s", height=176.0, floor=0.0)


def clearance_chart(run: RunFolder) -> str:
    """Draw the true distance from the robot's hull to the nearest obstacle; zero is contact."""
    t, clearance = run.column("t"), run.column("clearance")
    name = "clearance"
    dots = [
        (float(event["t"]), 0.0, f"collision at {clock(float(event['t']))}")
        for event in run.select("collision")
        if not event.get("robot")
    ]
    if np.isfinite(clearance).any():
        k = int(np.nanargmin(clearance))
        name = f"clearance: closest pass {clearance[k]:.2f} m at {clock(float(t[k]))}"
        dots.append((float(t[k]), min(FARTHEST_M, float(clearance[k])), name))
    return curves_chart(
        run.duration_s,
        t,
        {name: np.minimum(clearance, FARTHEST_M)},
        "clearance, m",
        ceiling=FARTHEST_M,
        ticks={0.0: "0", 0.5: "0.5", 1.0: "1", 1.5: "1.5", FARTHEST_M: "2+"},
        bands=[(0.0, ROBOT_RADIUS_M, "band")],
        limits=[(0.0, "limit")],
        dots=dots,
    )


LANES = (
    ("first", "first question"),
    ("distance", "near the goal"),
    ("stuck", "stuck"),
    ("failure", "planner failed"),
    ("deviation", "off the path"),
    ("own", "own trigger"),
    ("instruction", "new instruction"),
)
THINKING = "advisor thinking"
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


def event_chart(run: RunFolder, made: Sequence[Decision]) -> str:
    """Draw when and why the advisor was or was not asked, its latency, and its mode."""
    triggers = run.select("trigger")
    causes = {str(event.get("cause")) for event in triggers}
    lanes = {key: name for key, name in LANES if key in causes}
    lanes |= {cause: cause for cause in sorted(causes - lanes.keys())}
    bars = []
    for cause, name in lanes.items():
        held: dict[str, list[float]] = {}
        for event in triggers:
            if event.get("cause") == cause and not event.get("fired"):
                held.setdefault(str(event.get("held_by") or "held"), []).append(float(event["t"]))
        for why, times in held.items():
            for start, end in _stretches(times):
                said = f"{clock(start)}–{clock(end)}: held back ({HELD.get(why, why)})"
                bars.append(Bar(lane=name, start=start, end=end, said=said, cls=f"held {why}", height=8))
        for event in triggers:
            if event.get("cause") == cause and event.get("fired"):
                t = float(event["t"])
                said = f"{clock(t)}: asked ({name})"
                bars.append(Bar(lane=name, start=t, end=t, said=said, cls="fired", height=11, least=11))
    for decision in made:
        for one in decision.tries:
            end = one.answered_at_s if one.answered_at_s is not None else run.duration_s
            said = f"decision {decision.number}, {one.verdict} {one.code}"
            cls, number = f"ask {one.verdict}", decision.number
            bars.append(Bar(lane=THINKING, start=one.asked_at_s, end=end, said=said, cls=cls, decision=number))
    modes = [event for event in run.select("mode") if not event.get("robot")]
    ends = [*(float(event["t"]) for event in modes[1:]), run.duration_s]
    for event, end in zip(modes, ends, strict=False):
        start, mode = float(event["t"]), str(event.get("mode", ""))
        said = f"{clock(start)}–{clock(end)}: {mode}"
        bars.append(Bar(lane="mode", start=start, end=end, said=said, cls=f"mode {mode}", name=mode))
    for event in run.select(*INCIDENTS):
        t, kind = float(event["t"]), str(event["event"])
        said = f"{clock(t)}: {INCIDENTS[kind]}"
        bars.append(Bar(lane="incidents", start=t, end=t, said=said, cls=f"incident {kind}"))
    rows = [*lanes.values(), THINKING, "mode", "incidents"]
    return lanes_chart(run.duration_s, rows, bars, "Triggers and decisions over time")


def _stretches(times: Sequence[float], gap: float = 0.35) -> list[tuple[float, float]]:
    joined: list[tuple[float, float]] = []
    for t in times:
        if joined and t - joined[-1][1] <= gap:
            joined[-1] = (joined[-1][0], t)
        else:
            joined.append((t, t))
    return joined
