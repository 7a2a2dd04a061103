"""The inspection curves of a run report: share of the oyster area imaged, and inspected, over time."""

from __future__ import annotations

import math

import numpy as np

from coral.run_files import SurveyFiles
from coral.view.run import RunFolder, read_table
from coral.view.svg import LEFT, Span, chart, clock, line, path, text, time_axis

MARKS = (0.5, 0.8, 0.9, 1.0)
"""Shares whose times are marked on the curve of the inspected area."""


def imaging_chart(run: RunFolder) -> str:
    """Draw both curves over time; "" for a run without them."""
    table = read_table(run.path / SurveyFiles.JUDGE)
    if not {"t", "imaged", "inspected"} <= table.keys() or not len(table["t"]):
        return ""
    axis = time_axis(run.duration_s)
    top, bottom = 26.0, 196.0
    y = Span(0.0, 1.0, bottom, top)
    body = []
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        body += [
            line(axis.start_px, y(share), axis.end_px, y(share), "grid"),
            text(LEFT - 8, y(share) + 4, f"{share:.0%}", "tick", "end"),
        ]
    t, inspected = table["t"], table["inspected"]
    for name, cls in (("imaged", "curve faint"), ("inspected", "curve main")):
        values = table[name]
        keep = np.concatenate([[True], np.diff(values) != 0.0])
        keep[-1] = True
        body.append(path([axis(float(a)) for a in t[keep]], [y(float(b)) for b in values[keep]], cls, steps=True))
    for share in MARKS:
        reached = np.flatnonzero(inspected >= share - 1e-6)
        if reached.size:
            at = float(t[reached[0]])
            body.append(
                f'<circle cx="{axis(at):.1f}" cy="{y(share):.1f}" r="4.5" class="dot main"><title>'
                f"{share:.0%} inspected at {clock(at)}</title></circle>"
            )
    last = inspected[-1]
    body += [
        text(LEFT - 68, (top + bottom) / 2, "oyster area", "name rot"),
        text(axis.end_px, top - 8, f"inspected {last:.0%}" if math.isfinite(last) else "inspected", "key main", "end"),
        text(axis.end_px - 124, top - 8, "imaged", "key faint", "end"),
    ]
    return chart(224, body, axis, label="Imaged and inspected over time", top=top, bottom=bottom)
