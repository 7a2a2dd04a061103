"""Top views of reef worlds in the colours of the robot's map: clusters, obstacles, start, current, scale."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from coral.drawing import RGB, Image, contact_sheet, draw_arrow, draw_line, draw_text, png
from coral.file_writer import write_whole
from coral.odd_text import printable
from coral.reef.pictures.mapframe import CELL_COLORS
from coral.reef.pictures.mapview import MapScene, draw_map
from coral.reef.world.geometry import Label, Pose
from coral.reef.world.world import ReefWorld
from coral.view.mapsvg import solid_outlines

SIZE_PX, SMALL_PX = 800, 400
"""Edge of one picture alone, and of one on a sheet."""
CELL_M = 0.05
CLASSES = {Label.OBSTACLE: 2, Label.OYSTER: 3}
"""Classes of the map's cells by what a solid is."""
SPINE: RGB = (95, 130, 155)
FLOW: RGB = (31, 95, 176)
_NUMBERED_M = 40.0
"""Larger worlds have no numbers on a sheet: there they would hide the clusters."""


def preview(world: ReefWorld, path: Path) -> Path:
    """Draw one world as a PNG."""
    width, height = world.size_m
    oysters = sum(len(cluster.oysters) for cluster in world.clusters)
    title = (
        f"{printable(world.name)}: {width:g} × {height:g} m, {len(world.clusters)} clusters, {oysters} oysters, "
        f"{len(world.obstacles) + len(world.walls)} obstacles"
    )
    drawn = _draw(world, SIZE_PX, (0.0, 0.0, width, height))
    write_whole(path, png(contact_sheet([(title, drawn)], 1)))
    return path


def preview_sheet(worlds: Sequence[ReefWorld], path: Path, columns: int = 5) -> Path:
    """Draw several worlds on one sheet, all at the same scale."""
    widest = max(edge for world in worlds for edge in world.size_m)
    pictures = []
    for world in worlds:
        width, height = world.size_m
        left, below = 0.5 * (width - widest), 0.5 * (height - widest)
        window = left, below, left + widest, below + widest
        title = f"{printable(world.name)}   {width:g} × {height:g} m"
        pictures.append((title, _draw(world, SMALL_PX, window, numbers=widest <= _NUMBERED_M)))
    write_whole(path, png(contact_sheet(pictures, columns)))
    return path


def _draw(world: ReefWorld, size_px: int, window: tuple[float, float, float, float], numbers: bool = True) -> Image:
    """Draw a world as a map that shows all there is, in a window (x0, y0, x1, y1) in metres. Shape=(H, W, 3)."""
    width, height = world.size_m
    cells = np.ones((math.ceil(height / CELL_M), math.ceil(width / CELL_M)), np.uint8)
    for label, points in solid_outlines(world):
        if label in CLASSES:
            cv2.fillPoly(cells, [np.rint(points / CELL_M).astype(np.int32)], CLASSES[label])
    middles = [np.mean([(o.x, o.y) for o in cluster.oysters], axis=0) for cluster in world.clusters if numbers]
    scene = MapScene(
        cells=cells,
        floor=CELL_COLORS[cells],  # with it, dots are small
        cell_m=CELL_M,
        pose=Pose(world.start.x, world.start.y, world.start.theta),
        trajectory=np.empty((0, 2)),
        centroids=np.array(middles).reshape(-1, 2),
        links=(),
        marks=[(thing.x, thing.y, printable(thing.kind).replace("-", " ")) for thing in world.things if numbers],
    )
    drawn = draw_map(scene, size_px=size_px, window=window, legend=False)
    for line in world.spine:
        draw_line(drawn.rgb, drawn.to_pixels(np.array(line)), SPINE, 1)
    flow = np.array([world.current.x_m_s, -world.current.y_m_s])
    if (speed := float(np.hypot(*flow))) >= 0.0005:
        corner = drawn.to_pixels(np.array(drawn.window[2:])) - np.array([34, -26])
        draw_arrow(drawn.rgb, corner - 15 * flow / speed, corner + 15 * flow / speed, FLOW)
        said = f"current {100 * speed:.1f} cm/s"
        draw_text(drawn.rgb, said, corner[0] - 24, corner[1], size=14, color=FLOW, halo=2, anchor="rm")
    return drawn.rgb
