"""Curves over time on one scale, with a legend."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from coral.view.svg import LEFT, RIGHT, WIDTH, Floats, Span, chart, levels, line, path, text, thin, time_axis

HUES = ("#0b6470", "#c8352b", "#b86e00", "#5a3ea8", "#178048", "#195ae6", "#8a4b2a", "#be00aa", "#5d6b7a", "#7a8f00")
"""Colours of curves, distinguishable in this order for most people."""


def curves_chart(
    duration_s: float,
    t: Floats,
    curves: Mapping[str, Floats],
    label: str,
    *,
    height: float = 216.0,
    floor: float | None = None,
    bands: Sequence[tuple[float, float]] = (),
    marks: Sequence[float] = (),
) -> str:
    """Draw curves on one scale, with a legend above.

    Args:
        duration_s: Length of the time axis (s).
        t: Shape=(N,) s.
        curves: Name to values, Shape=(N,).
        label: Label of the vertical axis, also for screen readers.
        height: Height of the plot (px).
        floor: A value that the scale must include.
        bands: Wanted values with their tolerances.
        marks: Times (s) of vertical lines, such as the beginnings of stages.
    """
    axis = time_axis(duration_s)
    legend, rows = _legend(list(curves))
    top, bottom = 14.0 + 16.0 * rows, height - 42.0 + 16.0 * rows
    height += 16.0 * (rows - 1)
    finite = [values[np.isfinite(values)] for values in curves.values()]
    everything = np.concatenate([*finite, np.array([value + off for value, off in bands]), np.zeros(1)])
    low = float(everything.min()) if floor is None else min(floor, float(everything.min()))
    y = Span(low, float(everything.max()) + 1e-6, bottom, top)
    body = levels(axis, y, {value: f"{value:g}" for value in y.ticks(5)})
    for value, off in bands:
        upper, lower = y(value + off), y(max(value - off, low))
        body.append(
            f'<rect x="{LEFT}" y="{upper:.1f}" width="{axis.end_px - LEFT:.1f}" height="{lower - upper:.1f}" '
            'style="fill:#17804818"/>'
        )
        body.append(line(axis.start_px, y(value), axis.end_px, y(value), "limit main"))
    body += [line(axis(mark), top, axis(mark), bottom, "limit main") for mark in marks]
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
