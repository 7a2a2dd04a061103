"""Charts over time as plain SVG text, which embed in a page, scale, print, and need no library."""

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


def levels(axis: Span, y: Span, ticks: Mapping[float, str]) -> list[str]:
    """Draw a line across the chart at each value, with its label on the left."""
    lines = [line(axis.start_px, y(value), axis.end_px, y(value), "grid") for value in ticks]
    return lines + [text(LEFT - 8, y(value) + 4, label, "tick", "end") for value, label in ticks.items()]


def path(xs: Sequence[float] | Floats, ys: Sequence[float] | Floats, cls: str, *, steps: bool = False) -> str:
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
    return f'<path d="{"".join(parts)}" class="{cls}"/>' if parts else ""


def chart(
    height: float, body: Sequence[str], axis: Span, *, label: str, top: float, bottom: float, show_times: bool = True
) -> str:
    """Wrap drawn parts into an SVG with a time axis and the cursor that follows the time slider.

    Args:
        height: Height of the picture (px of its own coordinates).
        body: Parts from the functions above.
        axis: Time axis from `time_axis`.
        label: Label for screen readers.
        top: Upper edge of the plot area (px).
        bottom: Lower edge of the plot area (px).
        show_times: Whether to write the times below.
    """
    grid = [line(axis(t), top, axis(t), bottom, "grid") for t in time_ticks(axis)]
    times = [text(axis(t), bottom + 18, clock(t), "tick") for t in time_ticks(axis)] if show_times else []
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
