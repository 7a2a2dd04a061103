"""Figure of coverage, collisions and time over the values of each swept key, one column of panels per key."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from coral.campaign.measures import Measure, Row, mean
from coral.campaign.overlay import COLORS, MORE_COLORS
from coral.campaign.sweep import in_order
from coral.file_writer import write_whole
from coral.foreign_file import parse_json
from coral.odd_text import printable

EDGED = "#3a3000"
"""Edge colour of the markers: the paper's yellow is pale on white."""
UNITS = {"current": "m/s", "visibility": "m", "mask_errors": "share", "depth_noise": "m/m", "pose_drift": "m/√s"}


def draw_sweep(variants: Mapping[str, Sequence[Row]], measures: Sequence[Measure], path: Path, *, title: str) -> bool:
    """Write the figure as PNG; return False, and write no file, if nothing was swept.

    Args:
        variants: Finished missions of every setting by variant, under one advisor.
        measures: One row of panels each.
        path: Path of the picture; replaced.
        title: Title of the figure.
    """
    swept = _values(variants)
    if not swept:
        return False
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(max(6.0, 2.3 * len(swept)), 1.7 * len(measures) + 0.8), layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.subplots(len(measures), len(swept), squeeze=False, sharex="col", sharey="row")
    for line, measure in enumerate(measures):
        for column, (key, values) in enumerate(swept.items()):
            axes = grid[line, column]
            for k, (variant, rows) in enumerate(variants.items()):
                _line(axes, rows, key, values, measure, COLORS.get(variant) or MORE_COLORS[k % len(MORE_COLORS)])
            axes.set_xticks(range(len(values)), map(_text, values))
            axes.set_xlim(-0.4, len(values) - 0.6)
            axes.tick_params(labelsize=7, length=2)
            axes.grid(alpha=0.25, lw=0.5)
            if line == 0:
                axes.set_title(f"{key} ({UNITS[key]})" if key in UNITS else key.rsplit(".", 1)[-1], fontsize=8)
        grid[line, 0].set_ylabel(measure.label, fontsize=8)
        low, high = grid[line, 0].get_ylim()
        grid[line, 0].set_ylim(*((-4.0, 104.0) if measure.key == "coverage" else (min(low, 0.0), max(high, 1.0))))
    if len(variants) > 1:
        figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=6, fontsize=8)
    figure.suptitle(f"{printable(title)}\ndashed: nominal · bars: 95 % intervals", fontsize=8, parse_math=False)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=120)
    write_whole(path, buffer.getvalue())
    return True


def _values(variants: Mapping[str, Sequence[Row]]) -> dict[str, list[Any]]:
    """Map each key to its values, in order; leave out settings that change several keys at once."""
    swept: dict[str, list[Any]] = {}
    for text in in_order(row["overrides"] for rows in variants.values() for row in rows):
        changes = parse_json(text)
        if len(changes) == 1:
            [(key, value)] = changes.items()
            swept.setdefault(key, []).append(value)
    return swept


def _line(axes: Any, rows: Sequence[Row], key: str, values: Sequence[Any], measure: Measure, color: str) -> None:
    """Draw means with error bars over the values, and the nominal mean across."""
    nominal = mean([row for row in rows if row["overrides"] == "{}"], measure)
    if nominal.count:
        axes.axhline(nominal.mean, color=color, lw=1.2, ls=(0, (4, 3)), zorder=1)
    points = []
    for place, changes in enumerate({key: value} for value in values):
        estimate = mean([row for row in rows if parse_json(row["overrides"]) == changes], measure)
        if estimate.count:
            points.append((place, estimate))
    axes.plot(
        [x for x, _ in points],
        [e.mean for _, e in points],
        "-o",
        color=color,
        mec=EDGED,
        mew=0.6,
        ms=4,
        lw=1.3,
        label=str(rows[0]["variant"]) if rows else "",
    )
    for x, estimate in points:
        axes.plot([x, x], [estimate.low, estimate.high], color=color, lw=3, alpha=0.45, solid_capstyle="butt")


def _text(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
