"""The charts over time of a contact report: stages, cost, forces, motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.view.run import Record, RunFolder
from coral.view.svg import LEFT, RIGHT, WIDTH, Span, chart, line, path, text, thin, time_axis

Floats = NDArray[np.float64]
HUES = ("#0b6470", "#c8352b", "#b86e00", "#5a3ea8", "#178048", "#195ae6", "#8a4b2a", "#be00aa", "#5d6b7a", "#7a8f00")
"""Colours of curves, distinguishable in this order for most people."""


def stages_chart(run: RunFolder) -> str:
    """Draw the active stage and the contacts over time."""
    axis = time_axis(run.duration_s)
    touches = touching(run)
    pairs = list(dict.fromkeys((touch["first"], touch["second"]) for touch in touches))
    again = run.select("stuck", "cost_error")
    rows = ["stage", *(f"{first} – {second}" for first, second in pairs), *(["asked again"] if again else [])]
    top, pitch = 10.0, 26.0
    bottom = top + pitch * len(rows)
    body = []
    for k, name in enumerate(rows):
        middle = top + pitch * (k + 0.5)
        body.append(line(axis.start_px, middle, axis.end_px, middle, "lane"))
        body.append(text(LEFT - 8, middle + 4, name, "tick", "end"))
    names = stage_names(run)
    for start, end, name in stage_spans(run):
        hue = HUES[names.index(name) % len(HUES)]
        body.append(_bar(axis, start, end, top + pitch / 2, 16, hue, 0.25, f"{name}: {start:.2f} to {end:.2f} s"))
        if axis(end) - axis(start) > 7.5 * len(name):
            body.append(text(axis(start) + 6, top + pitch / 2 + 4, name, "inbar", "start"))
    for touch in touches:
        middle = top + pitch * (1.5 + pairs.index((touch["first"], touch["second"])))
        said = (
            f"{touch['begun_s']:.2f} to {touch['ended_s']:.2f} s, mean {touch['mean_n']:.1f} N, "
            f"at most {touch['peak_n']:.1f} N"
        )
        body.append(_bar(axis, touch["begun_s"], touch["ended_s"], middle, 10, HUES[0], 0.8, said))
    for event in again:
        said = f"{float(event['t']):.2f} s: {event.get('text') or event.get('reason', '')}"
        body.append(_bar(axis, float(event["t"]), float(event["t"]), bottom - pitch / 2, 16, HUES[2], 1.0, said))
    return chart(bottom + 26, body, axis, label="Stages and contacts over time", top=top, bottom=bottom)


def cost_chart(run: RunFolder) -> str:
    """Draw the expected cost of each plan, term by term, and the effective number of samples."""
    plans = run.select("plan")
    names = list(dict.fromkeys(name for plan in plans for name in plan.get("terms", {})))
    t = np.array([float(plan["t"]) for plan in plans])
    curves = {name: np.array([_value(plan["terms"].get(name)) for plan in plans]) for name in names}
    return curves_chart(run, t, curves, "expected cost", stages=True)


def _value(value: object) -> float:
    return float(value) if isinstance(value, int | float) else float("nan")


def samples_chart(run: RunFolder) -> str:
    """Draw the effective sample size of each plan."""
    plans = run.select("plan")
    t = np.array([float(plan["t"]) for plan in plans])
    return curves_chart(
        run,
        t,
        {"effective samples": np.array([float(plan["ess"]) for plan in plans])},
        "samples",
        height=150.0,
        floor=0.0,
    )


def force_chart(run: RunFolder, objects: Sequence[str]) -> str:
    """Draw the hand's net force on each object, with the force that the task asks for."""
    felt = np.sqrt(sum(np.square(run.column(f"f{axis}")) for axis in "xyz"))
    curves = {
        "measured at the wrist": np.asarray(felt),  # first, so that the forces on objects lie on top
        **{f"on the {name}": run.column(f"{name}_hand_force") for name in objects},
    }
    bands = [(value, value * share) for _, value, share in _forces(run)]
    return curves_chart(run, run.column("t"), curves, "force, N", floor=0.0, bands=bands)


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
    return curves_chart(run, run.column("t"), curves, "height, m", stages=True)


def opening_chart(run: RunFolder) -> str:
    """Draw the distance between the fingers, commanded and measured."""
    curves = {"measured": 1e3 * run.column("opening"), "commanded": 1e3 * run.column("cmd_opening")}
    return curves_chart(run, run.column("t"), curves, "opening, mm", height=150.0, floor=0.0)


def tracking_chart(run: RunFolder, objects: Sequence[str]) -> str:
    """Draw the errors of the tracked poses; "" if none were tracked."""
    curves = {name: 1e3 * run.column(f"{name}_off_m") for name in objects}
    if not any(np.isfinite(values).any() for values in curves.values()):
        return ""
    return curves_chart(run, run.column("t"), curves, "off, mm", height=150.0, floor=0.0)


def tracks(run: RunFolder) -> str:
    """Describe in a sentence when objects were lost and found again."""
    said = [
        f"{event['object']} lost at {event['t']:.2f} s ({event['reason']})"
        if event["lost"]
        else f"{event['object']} found at {event['t']:.2f} s"
        for event in run.select("track")
    ]
    return f"{'; '.join(said[:20])}{' …' if len(said) > 20 else ''}." if said else "No object was lost."


def curves_chart(
    run: RunFolder,
    t: Floats,
    curves: Mapping[str, Floats],
    label: str,
    *,
    height: float = 216.0,
    floor: float | None = None,
    bands: Sequence[tuple[float, float]] = (),
    stages: bool = False,
) -> str:
    """Draw curves on one scale, with a legend above.

    Args:
        run: The run.
        t: Shape=(N,) s.
        curves: Name to values, Shape=(N,).
        label: Label of the vertical axis, also for screen readers.
        height: Height of the plot (px).
        floor: A value that the scale must include.
        bands: Wanted values with their tolerances.
        stages: Whether to mark the beginning of each stage.
    """
    axis = time_axis(run.duration_s)
    legend, rows = _legend(list(curves))
    top, bottom = 14.0 + 16.0 * rows, height - 42.0 + 16.0 * rows
    height += 16.0 * (rows - 1)
    finite = [values[np.isfinite(values)] for values in curves.values()]
    everything = np.concatenate([*finite, np.array([value + off for value, off in bands]), np.zeros(1)])
    low = float(everything.min()) if floor is None else min(floor, float(everything.min()))
    y = Span(low, float(everything.max()) + 1e-6, bottom, top)
    body = [
        part
        for value in y.ticks(5)
        for part in (
            line(axis.start_px, y(value), axis.end_px, y(value), "grid"),
            text(LEFT - 8, y(value) + 4, f"{value:g}", "tick", "end"),
        )
    ]
    for value, off in bands:
        upper, lower = y(value + off), y(max(value - off, low))
        body.append(
            f'<rect x="{LEFT}" y="{upper:.1f}" width="{axis.end_px - LEFT:.1f}" height="{lower - upper:.1f}" '
            'style="fill:#17804818"/>'
        )
        body.append(line(axis.start_px, y(value), axis.end_px, y(value), "limit main"))
    if stages:
        began = [axis(start) for start, _, _ in stage_spans(run) if start > 0]
        body += [line(x, top, x, bottom, "limit main") for x in began]
    body += legend
    for k, values in enumerate(curves.values()):
        times, kept = thin(t, values)
        curve = path([axis(float(a)) for a in times], [y(float(b)) for b in kept], "curve")
        body.append(curve.replace('class="curve"', f'class="curve" style="{_stroke(k)}"'))
    body.append(text(LEFT - 78, (top + bottom) / 2, label, "name rot"))
    return chart(height, body, axis, label=label, top=top, bottom=bottom)


def _stroke(k: int) -> str:
    """Return the style of curve number k: when the colours are used up, they come again dashed."""
    return f"stroke:{HUES[k % len(HUES)]}" + (";stroke-dasharray:5 3" if k // len(HUES) % 2 else "")


def _legend(names: Sequence[str]) -> tuple[list[str], int]:
    """Draw names beside their colours; return also the number of rows."""
    parts, x, row = [], LEFT, 0
    for k, name in enumerate(names):
        width = 34.0 + 7.2 * len(name)
        if x + width > WIDTH - RIGHT and x > LEFT:
            x, row = LEFT, row + 1
        y = 10 + 16 * row
        parts.append(f'<line x1="{x:.1f}" y1="{y}" x2="{x + 13:.1f}" y2="{y}" style="{_stroke(k)};stroke-width:4"/>')
        parts.append(text(x + 17, 14 + 16 * row, name, "tick", "start"))
        x += width
    return parts, row + 1


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
            found.append(
                {
                    **event,
                    "begun_s": float(event["t"]),
                    "ended_s": run.duration_s,
                    "mean_n": float(event["force_n"]),
                    "peak_n": float(event["force_n"]),
                }
            )
    return sorted(found, key=lambda event: float(event["begun_s"]))


def _conditions(run: RunFolder) -> list[dict[str, Any]]:
    success = run.world.get("success")
    found = success.get("conditions") if isinstance(success, dict) else None
    return [item for item in found if isinstance(item, dict)] if isinstance(found, list) else []


def _bar(
    axis: Span, start: float, end: float, middle: float, height: float, hue: str, opacity: float, said: str
) -> str:
    x = min(axis(start), WIDTH - RIGHT - 4.0)  # a contact at the very end is seen, too
    width = min(max(4.0, axis(min(end, axis.high)) - x), WIDTH - RIGHT - x)
    return (
        f'<rect x="{x:.1f}" y="{middle - height / 2:.1f}" width="{width:.1f}" '
        f'height="{height}" rx="2" style="fill:{hue};opacity:{opacity}"><title>{escape(said)}</title></rect>'
    )
