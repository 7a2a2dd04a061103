"""Top views of reef worlds, as a person plans a dive: clusters, obstacles, start, current, scale."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from coral.reef.world import Obstacle, ReefWorld

WATER, OYSTER, ROCK, SPINE, START, FLOW = "#f4f1e8", "#3f8f4f", "#2b2b2b", "#9db8c9", "#d1342b", "#2f6db5"


def preview(world: ReefWorld, path: Path) -> Path:
    """Draw one world as a PNG."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.2, 7.6), dpi=110, layout="constrained")
    _draw(figure.subplots(), world, detail=True)
    figure.savefig(path)
    return path


def preview_sheet(worlds: Sequence[ReefWorld], path: Path, columns: int = 5) -> Path:
    """Draw several worlds on one sheet, all at the same scale."""
    from matplotlib.figure import Figure

    rows = math.ceil(len(worlds) / columns)
    figure = Figure(figsize=(3.3 * columns, 3.55 * rows), dpi=110, layout="constrained")
    span = max(max(world.size_m) for world in worlds)
    for k, axes in enumerate(np.atleast_1d(figure.subplots(rows, columns)).ravel()):
        if k < len(worlds):
            _draw(axes, worlds[k], detail=False)
            width, height = worlds[k].size_m
            axes.set_xlim(width / 2 - span / 2, width / 2 + span / 2)
            axes.set_ylim(height / 2 - span / 2, height / 2 + span / 2)
        axes.set_axis_off()
    figure.savefig(path)
    return path


def _draw(axes: Any, world: ReefWorld, *, detail: bool) -> None:
    from matplotlib.collections import PatchCollection
    from matplotlib.patches import Ellipse, Rectangle

    width, height = world.size_m
    axes.add_patch(Rectangle((0, 0), width, height, facecolor=WATER, edgecolor="#8a8a8a", linewidth=0.8))
    for line in world.spine:
        axes.plot(*np.array(line).T, color=SPINE, linewidth=1.2, linestyle=(0, (4, 3)), zorder=1)
    oysters = [Ellipse((o.x, o.y), 2 * o.radii[0], 2 * o.radii[1], angle=math.degrees(o.rpy[2]))
               for cluster in world.clusters for o in cluster.oysters]
    axes.add_collection(PatchCollection(oysters, facecolor=OYSTER, edgecolor="none", zorder=2))
    axes.add_collection(PatchCollection([_outline(o) for o in world.obstacles], facecolor=ROCK, edgecolor="none", zorder=3))
    for k, cluster in enumerate(world.clusters):
        x = float(np.mean([o.x for o in cluster.oysters]))
        y = float(np.mean([o.y for o in cluster.oysters]))
        axes.annotate(cluster.name if detail else str(k), (x, y), color="white", fontsize=9, fontweight="bold",
                      ha="center", va="center", zorder=5,
                      bbox={"boxstyle": "round,pad=0.2", "facecolor": "#1f5c2e", "edgecolor": "none", "alpha": 0.85})
    s, reach = world.start, 0.06 * max(width, height)
    axes.annotate("", (s.x + reach * math.cos(s.theta), s.y + reach * math.sin(s.theta)), (s.x, s.y), zorder=6,
                  arrowprops={"arrowstyle": "-|>", "color": START, "linewidth": 2})
    axes.add_patch(Ellipse((s.x, s.y), 0.6, 0.6, facecolor=START, edgecolor="white", linewidth=0.8, zorder=6))
    speed = math.hypot(world.current.x_m_s, world.current.y_m_s)
    if speed > 0.005:
        ux, uy = world.current.x_m_s / speed, world.current.y_m_s / speed
        cx, cy = 0.93 * width, 0.07 * height
        axes.annotate("", (cx + 0.04 * width * ux, cy + 0.04 * width * uy), (cx - 0.04 * width * ux, cy - 0.04 * width * uy),
                      arrowprops={"arrowstyle": "->", "color": FLOW, "linewidth": 1.6}, zorder=6)
    if detail:
        axes.plot([0.04 * width, 0.04 * width + 5], [0.035 * height] * 2, color="#333333", linewidth=3, zorder=6)
        axes.text(0.04 * width + 2.5, 0.045 * height, "5 m", ha="center", va="bottom", fontsize=9)
        axes.set_xlabel("x (m)   green: oysters · black: obstacles · red: start · blue arrow: current")
        axes.set_ylabel("y (m)")
        axes.set_xlim(-0.3, width + 0.3)
        axes.set_ylim(-0.3, height + 0.3)
    axes.set_title(f"{world.name}   {width:g} × {height:g} m, {len(world.clusters)} clusters, "
                   f"{len(world.obstacles)} obstacles" if detail else f"{world.name}  ({width:g} × {height:g} m)", fontsize=11)
    axes.set_aspect("equal")


def _outline(obstacle: Obstacle) -> Any:
    from matplotlib.patches import Ellipse, Rectangle

    a, b, _ = obstacle.size
    if obstacle.shape == "box":
        c, s = math.cos(obstacle.yaw), math.sin(obstacle.yaw)
        corner = (obstacle.x - c * a + s * b, obstacle.y - s * a - c * b)
        return Rectangle(corner, 2 * a, 2 * b, angle=math.degrees(obstacle.yaw))
    return Ellipse((obstacle.x, obstacle.y), 2 * a, 2 * b, angle=math.degrees(obstacle.yaw))
