"""Charts over time as plain SVG text, curves and bars in lanes: they embed in a page, scale, print, need no library."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import NDArray

from coral.reef.pictures.mapframe import nice_step

LEFT, RIGHT = 122.0, 18.0
WIDTH = 1100.0
"""Charts share their horizontal layout, so that a time has the same position in all of them."""

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Span:
    """A linear scale from values to pixels."""

    low: float
    high: float
    start_px: float
    end_px: float

    def __call__(self, value: float) -> float:
        """Return the pixel of a value."""
        share = (value - self.low) / ((self.high - self.low) or 1.0)
        return self.start_px + share * (self.end_px - self.start_px)

    def ticks(self, at_most: int) -> list[float]:
        """Return round values inside the scale."""
        step = nice_step((self.high - self.low) or 1.0, at_most)
        return [k * step for k in range(math.ceil(self.low / step - 1e-9), math.floor(self.high / step + 1e-9) + 1)]


def time_axis(duration_s: float) -> Span:
    """Make the horizontal scale shared by all charts over time."""
    return Span(0.0, max(duration_s, 1e-3), LEFT, WIDTH - RIGHT)


def clock(t: float) -> str:
    """Format simulated time as m:ss."""
    seconds = round(t)
    return f"{seconds // 60}:{seconds % 60:02d}"


def time_ticks(axis: Span) -> list[float]:
    """Return round times: whole seconds or minutes, at most ten."""
    steps = (1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600)
    step = next((s for s in steps if axis.high / s <= 10), 7200)
    return [float(k * step) for k in range(int(axis.high // step) + 1)]


def text(x: float, y: float, words: str, cls: str = "", anchor: str = "middle") -> str:
    """Draw a label; `cls` names its style in the page."""
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" class="{cls}">{escape(words)}</text>'


def line(x1: float, y1: float, x2: float, y2: float, cls: str) -> str:
    """Draw a straight line."""
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" class="{cls}"/>'


def path(xs: Sequence[float] | Floats, ys: Sequence[float] | Floats, style: str, *, steps: bool = False) -> str:
    """Draw a curve through the finite points; `steps` holds each value until the next."""
    parts, pen = [], "M"
    last = math.nan
    for x, y in zip(xs, ys, strict=True):
        if not (math.isfinite(x) and math.isfinite(y)):
            pen = "M"
            continue
        if steps and pen == "L" and y != last:
            parts.append(f"L{x:.1f},{last:.1f}")
        parts.append(f"{pen}{x:.1f},{y:.1f}")
        pen, last = "L", y
    return f'<path d="{"".join(parts)}" class="curve" style="{style}"/>' if parts else ""


def chart(height: float, body: Sequence[str], axis: Span, *, label: str, top: float, bottom: float) -> str:
    """Wrap drawn parts into an SVG with a time axis from `time_axis` and the cursor that follows the time slider.

    Its height, and the edges of the plot area, are in px of its own coordinates. The label is for screen readers.
    """
    grid = [line(axis(t), top, axis(t), bottom, "grid") for t in time_ticks(axis)]
    times = [text(axis(t), bottom + 18, clock(t), "tick") for t in time_ticks(axis)]
    cursor = line(axis.end_px, top, axis.end_px, bottom, "cursor")
    return (
        f'<svg viewBox="0 0 {WIDTH:.0f} {height:.0f}" class="chart timed" role="img" aria-label="{escape(label)}">'
        f"{''.join(grid)}{''.join(body)}{line(axis.start_px, bottom, axis.end_px, bottom, 'axis')}"
        f"{''.join(times)}{cursor}</svg>"
    )


def thin(times: Floats, values: Floats, points: int = 900) -> tuple[Floats, Floats]:
    """Keep about `points` samples at most, including every extreme: the minimum and maximum of each slice."""
    if len(times) <= points:
        return times, values
    kept: list[int] = [0, len(times) - 1]
    for part in np.array_split(np.arange(len(times)), points // 2):
        finite = part[np.isfinite(values[part])]
        if finite.size:
            kept += [int(finite[np.argmin(values[finite])]), int(finite[np.argmax(values[finite])])]
    order = np.unique(kept)
    return times[order], values[order]


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
    ceiling: float | None = None,
    ticks: Mapping[float, str] | None = None,
    bands: Sequence[tuple[float, float, str]] = (),
    limits: Sequence[tuple[float, str]] = (),
    marks: Sequence[float] = (),
    dots: Sequence[tuple[float, float, str]] = (),
    steps: bool = False,
) -> str:
    """Draw curves over `t` (s), both Shape=(N,), on one scale, with a legend above. Screen readers read the label.

    The scale includes `floor` and ends at `ceiling`, by default the largest value; `ticks` are labelled in place of
    round values. `bands` are shaded from a lower to an upper value, `limits` are lines across; each has a class.
    `marks` are times (s) of vertical lines, `dots` have time (s), value and text. `steps` holds each value until the
    next.
    """
    axis = time_axis(duration_s)
    legend, rows = _legend(list(curves))
    top, bottom = 14.0 + 16.0 * rows, height - 42.0 + 16.0 * rows
    height += 16.0 * (rows - 1)
    finite = [values[np.isfinite(values)] for values in curves.values()]
    shaded = [value for low, high, _ in bands for value in (low, high)]
    everything = np.concatenate([*finite, np.array([*shaded, *(value for value, _ in limits), 0.0])])
    low = float(everything.min()) if floor is None else min(floor, float(everything.min()))
    y = Span(low, float(everything.max()) + 1e-6 if ceiling is None else ceiling, bottom, top)
    known = {value: f"{value:g}" for value in y.ticks(5)} if ticks is None else ticks
    body = [line(axis.start_px, y(value), axis.end_px, y(value), "grid") for value in known]
    body += [text(LEFT - 8, y(value) + 4, name, "tick", "end") for value, name in known.items()]
    body += [
        f'<rect x="{LEFT}" y="{y(high):.1f}" width="{axis.end_px - LEFT:.1f}" height="{y(low) - y(high):.1f}" '
        f'class="{cls}"/>'
        for low, high, cls in bands
    ]
    body += [line(axis.start_px, y(value), axis.end_px, y(value), cls) for value, cls in limits]
    body += [line(axis(mark), top, axis(mark), bottom, "limit main") for mark in marks]
    body += legend
    for k, values in enumerate(curves.values()):
        times, kept = thin(t, values)
        body.append(path([axis(float(a)) for a in times], [y(float(b)) for b in kept], _stroke(k), steps=steps))
    body += [
        f'<circle cx="{axis(at):.1f}" cy="{y(value):.1f}" r="4.5" class="dot"><title>{escape(said)}</title></circle>'
        for at, value, said in dots
    ]
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


@dataclass(frozen=True, kw_only=True)
class Bar:
    """A stretch of time in a lane."""

    lane: str
    start: float
    end: float
    said: str
    """What a pointer is told."""
    cls: str = ""
    style: str = ""
    height: float = 16.0
    least: float = 4.0
    """Smallest width (px); a moment is drawn in its middle."""
    name: str = ""
    """Written inside if there is room."""
    decision: int | None = None
    """Number of the decision that it belongs to."""


def lanes_chart(duration_s: float, lanes: Sequence[str], bars: Sequence[Bar], label: str) -> str:
    """Draw bars, in their order, in lanes from top to bottom. The label is for screen readers."""
    axis = time_axis(duration_s)
    top, pitch = 12.0, 28.0
    bottom = top + pitch * len(lanes)
    middle = {name: top + pitch * (k + 0.5) for k, name in enumerate(lanes)}
    body = [line(axis.start_px, y, axis.end_px, y, "lane") for y in middle.values()]
    body += [text(LEFT - 8, y + 4, name, "tick", "end") for name, y in middle.items()]
    for bar in bars:
        y, lasts = middle[bar.lane], axis(min(bar.end, axis.high)) - axis(bar.start)
        width = max(bar.least, lasts)
        x = min(max(axis(bar.start) - (width - lasts) / 2, axis.start_px), axis.end_px - width)
        number = "" if bar.decision is None else f' data-decision="{bar.decision}"'
        body.append(
            f'<rect x="{x:.1f}" y="{y - bar.height / 2:.1f}" width="{width:.1f}" height="{bar.height:g}" '
            f'rx="{bar.least / 2:g}" class="{escape(bar.cls)}" style="{bar.style}"{number}>'
            f"<title>{escape(bar.said)}</title></rect>"
        )
        if bar.name and width > 8.0 * len(bar.name):
            body.append(text(x + 6, y + 4, bar.name, "inbar", "start"))
    return chart(bottom + 26, body, axis, label=label, top=top, bottom=bottom)
