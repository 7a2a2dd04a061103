"""Trajectories of several variants over the true reef, one small picture per world (like the paper's Fig. 3)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from coral.campaign.reef_tables import name
from coral.campaign.spec import called
from coral.file_writer import write_whole
from coral.odd_text import printable
from coral.view.mapsvg import footprint
from coral.view.run import RunFolder

COLORS = {"dream": "#2b6cb8", "pd": "#e8590c", "full": "#f2b705"}
"""The paper's colours: blue, orange, yellow; an edge keeps the yellow readable on white."""
MORE_COLORS = ("#7b3fa0", "#00897b", "#c2185b", "#5d4037", "#455a64", "#6d8b00", "#00acc1", "#9e9d24")


def draw_overlay(runs: Mapping[str, Mapping[str, Path]], path: Path, *, seed: int, advisor: str) -> None:
    """Write the figure as PNG.

    Args:
        runs: Run folders by world and variant, in drawing order.
        path: Path of the picture; replaced.
        seed: Shown in the title.
        advisor: Shown in the title.
    """
    import io

    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    variants = list(dict.fromkeys(variant for folders in runs.values() for variant in folders))
    colors = {variant: COLORS.get(variant) or MORE_COLORS[k % len(MORE_COLORS)] for k, variant in enumerate(variants)}
    columns = min(len(runs), 5 if len(runs) > 4 else max(2, len(runs)))
    rows = math.ceil(len(runs) / columns)
    width = max(7.0, 3.3 * columns)
    side = width / columns
    figure = Figure(figsize=(width, side * rows + 0.85), layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.subplots(rows, columns, squeeze=False)
    for axes, (world, folders) in zip(grid.flat, runs.items(), strict=False):
        _panel(axes, world, {variant: RunFolder.read(folder) for variant, folder in folders.items()}, colors)
    for axes in list(grid.flat)[len(runs) :]:
        axes.axis("off")
    figure.legend(
        handles=_legend(variants, colors),
        loc="outside lower center",
        ncols=min(6, len(variants) + 4),
        frameon=False,
        fontsize=9,
    )
    figure.suptitle(
        f"Trajectories over the true reef (m) · seed {seed} · advisor {called(advisor)} · coverage in the "
        "legend's order",
        fontsize=9,
        parse_math=False,
    )
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=130)
    write_whole(path, buffer.getvalue())


def _panel(axes: Any, title: str, runs: Mapping[str, RunFolder], colors: Mapping[str, str]) -> None:
    world = next(iter(runs.values())).world
    _truth(axes, world)
    for variant, run in runs.items():
        x, y = run.column("x"), run.column("y")
        axes.plot(x, y, color="#3a3000" if variant == "full" else "white", lw=2.8, alpha=0.75, zorder=3)
        axes.plot(x, y, color=colors[variant], lw=1.7, zorder=4)
        if len(x):
            axes.plot(x[-1], y[-1], "o", color=colors[variant], ms=5, mec="black", mew=0.7, zorder=6)
    for variant, run in runs.items():
        hits = np.array([(event["x"], event["y"]) for event in run.select("collision")]).reshape(-1, 2)
        axes.plot(*hits.T, "X", color=colors[variant], ms=8, mec="#b00020", mew=1.2, zorder=7)
    start = world.get("start", {})
    axes.plot(start.get("x", 0), start.get("y", 0), "^", color="black", ms=6, zorder=6)
    size = world.get("size_m", (1, 1))
    axes.set(xlim=(0, size[0]), ylim=(0, size[1]), aspect="equal")
    covered = " / ".join(f"{100 * float(run.metrics.get('coverage', 0)):.0f}" for run in runs.values())
    axes.set_title(f"{printable(title)}: {covered} %", fontsize=9, parse_math=False)
    axes.tick_params(labelsize=7, length=2)


def _truth(axes: Any, world: Mapping[str, Any]) -> None:
    from matplotlib.collections import EllipseCollection, PolyCollection

    oysters = np.array(
        [(o["x"], o["y"], 2 * max(o["radii"])) for c in world.get("clusters", ()) for o in c["oysters"]]
    ).reshape(-1, 3)
    axes.add_collection(
        EllipseCollection(
            oysters[:, 2],
            oysters[:, 2],
            np.zeros(len(oysters)),
            units="xy",
            offsets=oysters[:, :2],
            transOffset=axes.transData,
            facecolor="#7cc47f",
            edgecolor="none",
            zorder=1,
        )
    )
    outlines = [outline for obstacle in world.get("obstacles", ()) if len(outline := footprint(obstacle))]
    axes.add_collection(PolyCollection(outlines, facecolor="#6b6b6b", edgecolor="none", zorder=2))


def _legend(variants: Sequence[str], colors: Mapping[str, str]) -> list[Any]:
    from matplotlib.lines import Line2D

    def mark(marker: str, color: str, label: str, **style: Any) -> Line2D:
        return Line2D([], [], ls="", marker=marker, color=color, label=label, **style)

    return [
        *(Line2D([], [], color=colors[variant], lw=2.5, label=name(variant)) for variant in variants),
        mark("X", "white", "collision", ms=8, mec="#b00020", mew=1.2),
        mark("^", "black", "start", ms=6),
        mark("o", "#7cc47f", "oysters", ms=7),
        mark("s", "#6b6b6b", "obstacle", ms=7),
    ]
