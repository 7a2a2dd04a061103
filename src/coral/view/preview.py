"""Top views of reef worlds: clusters, obstacles, start, current, scale."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from coral.odd_text import printable
from coral.reef.world.geometry import Label
from coral.reef.world.world import ReefWorld
from coral.view.mapsvg import solid_outlines

SEABED, OYSTER, OTHER, ROCK = "#f1ead8", "#2f9e4f", "#8a5526", "#2b2b2b"
SPINE, START, FLOW, INK = "#8fb3c9", "#d1342b", "#1f5fb0", "#26302a"

_NUMBERED_M = 40.0
"""Larger worlds have no numbers on a sheet: there they would hide the clusters."""


def preview(world: ReefWorld, path: Path) -> Path:
    """Draw one world as a PNG."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    figure = Figure(figsize=(7.4, 8.2), dpi=110, layout="constrained")
    axes = figure.subplots()
    _draw(axes, world, size=13)
    width, height = world.size_m
    oysters = sum(len(cluster.oysters) for cluster in world.clusters)
    axes.set_title(
        f"{printable(world.name)}: {width:g} × {height:g} m, {len(world.clusters)} clusters, {oysters} oysters, "
        f"{len(world.obstacles) + len(world.walls)} obstacles",
        fontsize=12,
        parse_math=False,
    )
    axes.set(xlabel="x (m)", ylabel="y (m)", xlim=(-0.2, width + 0.2), ylim=(-0.2, height + 0.2))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(nbins=8, integer=True, steps=[1, 2, 5, 10]))
    spacing = {"fontsize": 9.5, "handletextpad": 0.4, "columnspacing": 1.4}
    figure.legend(handles=_legend([world]), loc="outside lower center", ncols=3, frameon=False, **spacing)
    figure.savefig(path, format="png")
    return path


def preview_sheet(worlds: Sequence[ReefWorld], path: Path, columns: int = 5) -> Path:
    """Draw several worlds on one sheet, all at the same scale."""
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    rows = math.ceil(len(worlds) / columns)
    widest, highest = (max(world.size_m[axis] for world in worlds) for axis in (0, 1))
    figure = Figure(
        figsize=(3.5 * columns, (3.5 * highest / widest + 0.35) * rows + 0.35),
        dpi=110,
        layout=ConstrainedLayoutEngine(h_pad=0.1),
    )
    for k, axes in enumerate(np.atleast_1d(figure.subplots(rows, columns)).ravel()):
        axes.set_axis_off()
        if k >= len(worlds):
            continue
        width, height = worlds[k].size_m
        _draw(axes, worlds[k], size=8.5, numbers=widest <= _NUMBERED_M)
        axes.set_title(f"{printable(worlds[k].name)}   {width:g} × {height:g} m", fontsize=12, parse_math=False)
        axes.set_xlim(width / 2 - widest / 2 - 0.3, width / 2 + widest / 2 + 0.3)
        axes.set_ylim(height - highest - 0.3, height + 0.3)  # titles are on top of the worlds
    figure.legend(handles=_legend(worlds), loc="outside lower center", ncols=3, frameon=False, fontsize=11)
    figure.savefig(path, format="png")
    return path


def _draw(axes: Any, world: ReefWorld, *, size: float, numbers: bool = True) -> None:
    from matplotlib.collections import PatchCollection
    from matplotlib.patches import Ellipse, Polygon, Rectangle
    from matplotlib.patheffects import withStroke

    width, height = world.size_m
    halo = [withStroke(linewidth=2.6, foreground="white")]
    axes.add_patch(Rectangle((0, 0), width, height, facecolor=SEABED, edgecolor="#8a8a8a", linewidth=0.8))
    for line in world.spine:
        axes.plot(*np.array(line).T, color=SPINE, linewidth=1.2, linestyle=(0, (4, 3)), zorder=1)
    oysters = [
        Ellipse((o.x, o.y), 2 * o.radii[0], 2 * o.radii[1], angle=math.degrees(o.rpy[2]))
        for cluster in world.clusters
        for o in cluster.oysters
    ]
    axes.add_collection(PatchCollection(oysters, facecolor=OYSTER, edgecolor="none", zorder=2))
    if others := [(o.x, o.y) for group in (*world.alike, *world.lying) for o in group.oysters]:
        axes.scatter(*np.array(others).T, s=2, color=OTHER, zorder=2)
    rocks = [Polygon(points) for label, points in solid_outlines(world) if label == Label.OBSTACLE]
    axes.add_collection(PatchCollection(rocks, facecolor=ROCK, edgecolor="none", zorder=3))
    style: dict[str, Any] = {"ha": "center", "color": INK, "path_effects": halo}
    for thing in world.things if numbers else ():
        axes.plot(thing.x, thing.y, "D", color=OTHER, markersize=4, markeredgecolor="white", zorder=4)
        said = {**style, "color": OTHER, "fontsize": size - 3, "va": "top", "zorder": 5, "parse_math": False}
        below = printable(thing.kind).replace("-", " ")
        axes.annotate(below, (thing.x, thing.y), (0, -5), textcoords="offset points", **said)
    for k, cluster in enumerate(world.clusters if numbers else ()):
        x = float(np.mean([o.x for o in cluster.oysters]))
        y = float(np.mean([o.y for o in cluster.oysters]))
        axes.text(x, y, str(k), va="center_baseline", fontsize=size, fontweight="bold", zorder=5, **style)
    s = world.start
    axes.add_patch(Ellipse((s.x, s.y), 0.6, 0.6, facecolor=START, edgecolor="white", linewidth=0.8, zorder=6))
    ahead = s.x + 1.4 * math.cos(s.theta), s.y + 1.4 * math.sin(s.theta)
    axes.annotate("", ahead, (s.x, s.y), zorder=6, arrowprops=_arrow(START, 1.8))
    _draw_current(axes, world, size)
    bar = 5.0 if min(world.size_m) >= 12.0 else 1.0
    axes.plot([0.6, 0.6 + bar], [0.6, 0.6], color="white", linewidth=6, zorder=6, solid_capstyle="butt")
    axes.plot([0.6, 0.6 + bar], [0.6, 0.6], color=INK, linewidth=3, zorder=6, solid_capstyle="butt")
    axes.text(0.6 + bar / 2, 0.9, f"{bar:g} m", va="bottom", fontsize=size - 2, zorder=6, **style)
    axes.set_aspect("equal")


def _draw_current(axes: Any, world: ReefWorld, size: float) -> None:
    """Draw an arrow in the corner below on the right, with the speed above it."""
    from matplotlib.patheffects import withStroke

    vx, vy = world.current.x_m_s, world.current.y_m_s
    speed = math.hypot(vx, vy)
    if speed < 0.0005:
        return
    halo = [withStroke(linewidth=2.6, foreground="white")]
    x, y, dx, dy = world.size_m[0] - 1.9, 1.3, 0.75 * vx / speed, 0.75 * vy / speed
    arrow = axes.annotate("", (x + dx, y + dy), (x - dx, y - dy), zorder=7, arrowprops=_arrow(FLOW, 1.6))
    arrow.arrow_patch.set_path_effects(halo)
    said = f"{100 * speed:.1f} cm/s"
    style = {"fontsize": size - 2, "color": FLOW, "path_effects": halo, "zorder": 7}
    axes.text(x, y + 1.2, said, ha="center", va="bottom", **style)


def _arrow(color: str, width: float) -> dict[str, Any]:
    return {"arrowstyle": "-|>", "color": color, "linewidth": width, "shrinkA": 0, "shrinkB": 0}


def _legend(worlds: Sequence[ReefWorld]) -> list[Any]:
    """Return the legend's entries: what every world has, and of the rest what these have."""
    from matplotlib.lines import Line2D

    def mark(color: str, marker: str, label: str) -> Line2D:
        return Line2D([], [], color=color, marker=marker, linestyle="none", markersize=8, label=label)

    return [
        mark(OYSTER, "o", "oysters (number of the cluster)"),
        mark(ROCK, "s", "obstacles"),
        mark(START, "o", "start"),
        *([mark(OTHER, "D", "other things, by kind")] if any(world.things for world in worlds) else []),
        mark(FLOW, "$→$", "current"),
        Line2D([], [], color=SPINE, linestyle="--", label="line of growth"),
    ]
