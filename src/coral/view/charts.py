"""Charts over time, curves and bars in lanes, drawn by Matplotlib as SVG that embeds in a page."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import matplotlib
import numpy as np
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from coral.odd_text import printable
from coral.words import clock

LEFT, RIGHT, WIDTH = 122.0, 18.0, 1100.0
"""Charts share their horizontal layout (px), so that a time has the same position in all of them."""
INSIDE = WIDTH - LEFT - RIGHT
BELOW, LANE, ROW = 26.0, 28.0, 17.0
"""Heights (px) of the labels of times, of a lane, and of a row of the legend."""
HUES = ("#0b6470", "#c8352b", "#b86e00", "#5a3ea8", "#178048", "#195ae6", "#8a4b2a", "#be00aa", "#5d6b7a", "#7a8f00")
"""Colours of curves, distinguishable in this order for most people; used up, they come again dashed."""
EMBEDDED = (
    (r'<g id="[\w.]+_\d+"', "<g"),  # the same in all charts of a page
    (r"<g id=(.)(\d+)\|", r'<g class="ask" data-decision="\2" id=\1|'),
    (r" id=(.)\|(.*?)\1>", r"><title>\2</title>"),
    ("<use xlink:", "<use "),
)
"""What makes Matplotlib's SVG a part of a page: patterns, and what replaces them."""


def curves_chart(
    duration_s: float,
    t: NDArray[np.float64],
    curves: Mapping[str, NDArray[np.float64]],
    label: str,
    height: float = 158.0,
) -> Axes:
    """Draw curves over `t` (s), both Shape=(N,), on a scale that includes 0; return the axes, to draw more on them."""
    axes = _axes_over_time(duration_s, label, height)
    axes.update_datalim([(0, 0)])
    axes.set_ylabel(label, size=13)
    with matplotlib.rc_context({"path.simplify_threshold": 0.5}):
        for name, values in curves.items():
            axes.plot(t, values, label=printable(name), linewidth=2, clip_on=False)
    return axes


def lanes_chart(duration_s: float, lanes: Sequence[str], label: str) -> Axes:
    """Make empty lanes from top to bottom, for `bar` and `dot`: lane number k is at value k."""
    axes = _axes_over_time(duration_s, label, LANE * len(lanes))
    axes.set_yticks(range(len(lanes)), [printable(name) for name in lanes], parse_math=False)
    axes.set_ylim(len(lanes) - 0.5, -0.5)
    return axes


def _axes_over_time(duration_s: float, label: str, height: float) -> Axes:
    axes = Figure((WIDTH / 72, height / 72), dpi=72, facecolor="none").add_axes((0, 0, 1, 1), facecolor="none")
    axes.set(label=label, xlim=(0, max(duration_s, 1e-3)), ymargin=0, axisbelow=True)
    axes.set_prop_cycle(cycler(linestyle=["-", (0, (2.5, 1.5))]) * cycler(color=HUES))
    axes.spines[["left", "right", "top"]].set_visible(False)
    axes.tick_params(length=0, pad=8, labelsize=13)
    axes.grid(color="#e8ecf0", linewidth=1)
    step_s = next((s for s in (1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600) if duration_s / s <= 10), 7200)
    axes.set_xticks(ticks := np.arange(0, duration_s + 1e-6, step_s), [clock(t) for t in ticks])
    axes.locator_params(axis="y", nbins=5, steps=[1, 2, 5, 10])
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_label_coords(-78 / INSIDE, 0.5)
    return axes


def bar(
    axes: Axes, lane: int, begins_s: float, ends_s: float, told: str, color: str, height: float = 16.0, **style: Any
) -> None:
    """Draw a stretch of time in a lane, with what a pointer is told; a moment gets some width, its time in the middle.

    `name` is written inside if there is room; `decision` is the number of the decision it belongs to.
    """
    name, decision = style.pop("name", ""), style.pop("decision", "")
    px_s, ends_s = axes.get_xlim()[1] / INSIDE, min(ends_s, axes.get_xlim()[1])
    width_s = max(ends_s - begins_s, 4 * px_s)
    left_s = np.clip((begins_s + ends_s - width_s) / 2, 0.0, INSIDE * px_s - width_s)
    corner = (left_s, lane - height / LANE / 2)
    axes.add_artist(Rectangle(corner, width_s, height / LANE, facecolor=color, gid=f"{decision}|{told}", **style))
    if name and width_s > 8 * px_s * len(name):
        looks: Any = {"va": "center_baseline", "size": 12, "color": "#34465a", "parse_math": False}
        axes.text(left_s + 6 * px_s, lane, printable(name), **looks)


def dot(axes: Axes, at_s: float, value: float, told: str, size: float = 9.0, **style: Any) -> None:
    """Draw a dot of a size in px at a time and a value, with what a pointer is told."""
    style |= {"color": HUES[0], "mec": "white", "ms": size, "clip_on": False, "gid": f"|{told}"}
    axes.add_artist(Line2D([at_s], [value], marker="o", **style))


def svg(axes: Axes) -> str:
    """Return a chart as an SVG element, with a legend of all labels and the cursor that follows the time slider."""
    figure: Any = axes.figure
    label, inside, buffer = str(axes.get_label()), 72 * figure.get_figheight(), io.StringIO()
    handles, names = axes.get_legend_handles_labels()
    named = dict(zip(names, handles, strict=True))
    columns = max(1, int(INSIDE / (7.8 * max(map(len, named), default=1) + 34)))
    above = 8 + ROW * -(-len(named) // columns)
    height = above + inside + BELOW
    figure.set_figheight(height / 72)
    axes.set_position((LEFT / WIDTH, BELOW / height, INSIDE / WIDTH, inside / height))
    how: Any = {"svg.fonttype": "none", "svg.hashsalt": label, "text.parse_math": False, "font.family": "DejaVu Sans"}
    with matplotlib.rc_context(how), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a browser has glyphs that Matplotlib's own font lacks
        looks: Any = {"frameon": False, "fontsize": 13, "borderpad": 0, "handlelength": 1, "columnspacing": 1.2}
        axes.legend(named.values(), named, loc="lower left", bbox_to_anchor=(0, 1), ncols=columns, **looks)
        figure.savefig(buffer, format="svg")
    drawn = buffer.getvalue()
    drawn = drawn[drawn.index("<g ") : drawn.rindex("</svg>")]
    for pattern, replacement in EMBEDDED:
        drawn = re.sub(pattern, replacement, drawn)
    return (
        f'<svg viewBox="0 0 {WIDTH:.0f} {height:.0f}" class="chart timed" role="img" aria-label="{escape(label)}">'
        f'{drawn}<line y1="{above:.0f}" y2="{above + inside:.0f}" class="cursor"/></svg>'
    )
