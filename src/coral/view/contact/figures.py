"""The charts over time of a contact report: stages, cost, forces, motion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from coral.view.charts import HUES, bar, curves_chart, lanes_chart, svg
from coral.view.run import Record, RunFolder

LIMIT: dict[str, Any] = {"color": "#1b2733", "linewidth": 1, "linestyle": (0, (4, 3))}


def stages_chart(run: RunFolder) -> str:
    """Draw the active stage and the contacts over time."""
    again, touches, names = run.select("stuck", "cost_error"), touching(run), stage_names(run)
    pairs = list(dict.fromkeys(f"{touch['first']} – {touch['second']}" for touch in touches))
    lanes = ["stage", *pairs, *(["asked again"] if again else [])]
    axes = lanes_chart(run.duration_s, lanes, "Stages and contacts over time")
    for start, end, name in stage_spans(run):
        color = HUES[names.index(name) % len(HUES)]
        bar(axes, 0, start, end, f"{name}: {start:.2f} to {end:.2f} s", color, alpha=0.25, name=name)
    for touch in touches:
        lane = 1 + pairs.index(f"{touch['first']} – {touch['second']}")
        start, end = float(touch["begun_s"]), float(touch["ended_s"])
        said = f"{start:.2f} to {end:.2f} s, mean {touch['mean_n']:.1f} N, at most {touch['peak_n']:.1f} N"
        bar(axes, lane, start, end, said, HUES[0], 10, alpha=0.8)
    for event in again:
        t = float(event["t"])
        bar(axes, len(pairs) + 1, t, t, f"{t:.2f} s: {event.get('text') or event.get('reason', '')}", HUES[2])
    return svg(axes)


def cost_chart(run: RunFolder) -> str:
    """Draw the expected cost of each plan, term by term, and the effective number of samples."""
    plans = run.select("plan")
    names = list(dict.fromkeys(name for plan in plans for name in plan.get("terms", {})))
    t = np.array([float(plan["t"]) for plan in plans])
    curves = {name: np.array([_value(plan["terms"].get(name)) for plan in plans]) for name in names}
    return _with_stages(run, curves_chart(run.duration_s, t, curves, "expected cost"))


def _value(value: object) -> float:
    return float(value) if isinstance(value, int | float) else float("nan")


def samples_chart(run: RunFolder) -> str:
    """Draw the effective sample size of each plan."""
    plans = run.select("plan")
    t = np.array([float(plan["t"]) for plan in plans])
    curves = {"effective samples": np.array([float(plan["ess"]) for plan in plans])}
    return svg(curves_chart(run.duration_s, t, curves, "samples", 92.0))


def force_chart(run: RunFolder, objects: Sequence[str]) -> str:
    """Draw the hand's net force on each object, with the force that the task asks for."""
    felt = np.sqrt(sum(np.square(run.column(f"f{axis}")) for axis in "xyz"))
    curves = {
        "measured at the wrist": np.asarray(felt),  # first, so that the forces on objects lie on top
        **{f"on the {name}": run.column(f"{name}_hand_force") for name in objects},
    }
    axes = curves_chart(run.duration_s, run.column("t"), curves, "force, N")
    for _, value, share in _forces(run):
        axes.axhspan(max(0.0, value * (1 - share)), value * (1 + share), color=HUES[4], alpha=0.1)
        axes.axhline(value, **LIMIT)
    return svg(axes)


def wanted_forces(run: RunFolder) -> str:
    """Describe the band and the line of the chart of forces; "" if the task asks for no force."""
    said = {
        "steady-force": "Green band: the force that the task asks for",
        "peak-force": "Line: the most that it allows",
    }
    found = {kind: f" {said[kind]}, {value:g} N." for kind, value, _ in _forces(run)}
    return "".join(found.values())


def _forces(run: RunFolder) -> list[tuple[str, float, float]]:
    """Return kind, value (N) and relative tolerance of each condition on a force."""
    shares = {"steady-force": 0.4, "peak-force": 0.0}
    return [
        (str(c["kind"]), float(c["newtons"]), float(c.get("tolerance", shares[c["kind"]])))
        for c in _conditions(run)
        if c.get("kind") in shares
    ]


def motion_chart(run: RunFolder, objects: Sequence[str]) -> str:
    """Draw the heights above the table."""
    curves = {"tool": run.column("z"), **{name: run.column(f"{name}_z") for name in objects}}
    return _with_stages(run, curves_chart(run.duration_s, run.column("t"), curves, "height, m"))


def _with_stages(run: RunFolder, axes: Axes) -> str:
    """Draw a line where a stage began, but for the first."""
    for start, _, _ in stage_spans(run):
        if start > 0:
            axes.axvline(start, **LIMIT)
    return svg(axes)


def opening_chart(run: RunFolder) -> str:
    """Draw the distance between the fingers, commanded and measured."""
    curves = {"measured": 1e3 * run.column("opening"), "commanded": 1e3 * run.column("cmd_opening")}
    return svg(curves_chart(run.duration_s, run.column("t"), curves, "opening, mm", 92.0))


def tracking_chart(run: RunFolder, objects: Sequence[str]) -> str:
    """Draw the errors of the tracked poses; "" if none were tracked."""
    curves = {name: 1e3 * run.column(f"{name}_off_m") for name in objects}
    if not any(np.isfinite(values).any() for values in curves.values()):
        return ""
    return svg(curves_chart(run.duration_s, run.column("t"), curves, "off, mm", 92.0))


def tracks(run: RunFolder) -> str:
    """Describe in a sentence when objects were lost and found again."""
    said = [
        f"{event['object']} lost at {event['t']:.2f} s ({event['reason']})"
        if event["lost"]
        else f"{event['object']} found at {event['t']:.2f} s"
        for event in run.select("track")
    ]
    return f"{'; '.join(said[:20])}{' …' if len(said) > 20 else ''}." if said else "No object was lost."


def stage_names(run: RunFolder) -> list[str]:
    """Return the stages in the order of their first activation."""
    return list(dict.fromkeys(str(event["stage"]) for event in run.select("stage")))


def stage_spans(run: RunFolder) -> list[tuple[float, float, str]]:
    """Return start (s), end (s) and name of every activation of a stage."""
    events = run.select("stage")
    ends = [*(float(event["t"]) for event in events[1:]), run.duration_s][: len(events)]
    return [(float(event["t"]), end, str(event["stage"])) for event, end in zip(events, ends, strict=True)]


def touching(run: RunFolder) -> list[Record]:
    """Return every contact with beginning, end, mean and peak; in a killed run, open contacts end with the record."""
    found: list[Record] = [event for event in run.select("contact_end") if "begun_s" in event]
    known = {(event["first"], event["second"], round(float(event["begun_s"]), 3)) for event in found}
    for event in run.select("contact"):
        if (event["first"], event["second"], round(float(event["t"]), 3)) not in known and not run.complete:
            begun_s, force_n = float(event["t"]), float(event["force_n"])
            times = {"begun_s": begun_s, "ended_s": run.duration_s}
            found.append({**event, **times, "mean_n": force_n, "peak_n": force_n})
    return sorted(found, key=lambda event: float(event["begun_s"]))


def _conditions(run: RunFolder) -> list[dict[str, Any]]:
    success = run.world.get("success")
    found = success.get("conditions") if isinstance(success, dict) else None
    return [item for item in found if isinstance(item, dict)] if isinstance(found, list) else []
