"""Frame of a map picture: colours, axes in metres, scale bar, legend."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.drawing import RGB, Image, draw_arrow, draw_dot, draw_line, draw_text, text_size

CELL_COLORS: NDArray[np.uint8] = np.array([(255, 255, 255), (190, 193, 197), (0, 0, 0), (38, 166, 76)], np.uint8)
"""Colours: white unexplored, gray explored free, black obstacles, green oysters (CORAL III-A)."""

ORANGE: RGB = (255, 133, 0)
FAR: RGB = (150, 210, 70)
"""Of a dot that stands for oysters seen from afar only."""
PALE: RGB = (255, 208, 160)
"""Of a dot where most pictures show seabed."""
BORDER: RGB = (120, 90, 60)
BLUE: RGB = (25, 90, 230)
RED: RGB = (220, 20, 40)
YELLOW: RGB = (255, 217, 0)
YELLOW_EDGE: RGB = (92, 74, 0)
MAGENTA: RGB = (190, 0, 170)
MARK: RGB = (0, 92, 105)
"""Of what the advisor took something for."""
INK: RGB = (40, 44, 52)


@dataclass(frozen=True)
class MapPicture:
    """A drawn map and its position in the world."""

    rgb: Image
    """The picture, Shape=(h, w, 3); north is up, +x is right."""
    scale: float
    """Pixels per metre."""
    left_px: float
    """Column of x = 0."""
    bottom_px: float
    """Row of y = 0."""
    window: tuple[float, float, float, float]
    """Shown area (x0, y0, x1, y1) (m)."""

    def to_pixels(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Convert world points, Shape=(..., 2) m, to picture (column, row) px."""
        points = np.asarray(points, np.float64)
        return np.stack([self.left_px + self.scale * points[..., 0], self.bottom_px - self.scale * points[..., 1]], -1)


def nice_step(span: float, at_most: int) -> float:
    """Return the smallest of 1, 2, 5 times a power of ten that splits `span` into at most `at_most` parts."""
    power = 10.0 ** math.floor(math.log10(span / at_most))
    return next(power * k for k in (1.0, 2.0, 5.0, 10.0) if span / (power * k) <= at_most)


def draw_scale_bar(view: MapPicture) -> None:
    """Draw a scale bar in the lower left corner of a map, in place."""
    rgb = view.rgb
    height, width = rgb.shape[:2]
    metres = nice_step(width / view.scale, 6)
    length = metres * view.scale
    x, y = 12.0, height - 13.0
    text = f"{metres:g} m"
    w = text_size(text, 14, 600)[0]
    box = rgb[height - 27 : height - 2, 4 : round(x + length) + w + 18]
    box[:] = np.rint(0.15 * box + 0.85 * 255).astype(np.uint8)
    draw_line(rgb, np.array([(x, y), (x + length, y)]), INK, 3)
    for end in (x, x + length):
        draw_line(rgb, np.array([(end, y - 5), (end, y + 5)]), INK, 2)
    draw_text(rgb, text, x + length + 8, y, size=14, weight=600, anchor="lm")


def draw_axes(view: MapPicture, left: int, top: int, width: int, height: int) -> None:
    """Draw frame and ticks in metres around the map, in place; the map begins at (left, top) px."""
    rgb = view.rgb
    cv2.rectangle(rgb, (left - 1, top - 1), (left + width, top + height), (110, 114, 122), 1)
    x0, y0, x1, y1 = view.window
    step = nice_step(max(x1 - x0, y1 - y0), 8)
    for k in range(math.ceil(x0 / step - 1e-6), math.floor(x1 / step + 1e-6) + 1):
        column = view.left_px + view.scale * k * step
        draw_line(rgb, np.array([(column, top + height), (column, top + height + 5)]), (110, 114, 122), 1)
        if column < left + width - 46:  # the unit stands there
            draw_text(rgb, f"{k * step:g}", column, top + height + 15, size=14, anchor="mm")
    for k in range(math.ceil(y0 / step - 1e-6), math.floor(y1 / step + 1e-6) + 1):
        row = view.bottom_px - view.scale * k * step
        draw_line(rgb, np.array([(left - 6, row), (left - 1, row)]), (110, 114, 122), 1)
        if row > top + 6 or top > 22:
            draw_text(rgb, f"{k * step:g}", left - 9, row, size=14, anchor="rm")
    draw_text(rgb, "y (m)", 2, 9, size=14, weight=400, anchor="lm")
    draw_text(rgb, "x (m)", left + width, top + height + 15, size=14, weight=400, anchor="rm")


def draw_border(view: MapPicture, border: tuple[float, float, float, float]) -> None:
    """Draw the border of the survey area as a dashed line with its name, in place."""
    x0, y0, x1, y1 = border
    corners = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)])
    for a, b in itertools.pairwise(corners):
        length = float(np.hypot(*(b - a)))
        for k in range(math.ceil(length)):  # dashes of half a metre
            ends = a + np.outer([k / length, min(k + 0.5, length) / length], b - a)
            draw_line(view.rgb, view.to_pixels(ends), BORDER, 3)
    height, width = view.rgb.shape[:2]
    # Named once, at a corner that shows; not at the lower left, where the scale bar is.
    for x, y, anchor, across, down in ((x1, y1, "rm", -6, 12), (x0, y1, "lm", 6, 12), (x1, y0, "rm", -6, -12)):
        column, row = view.to_pixels(np.array([x, y]))
        if -1 <= row <= height + 1 and -1 <= column <= width + 1:
            text = "end of the survey area"
            draw_text(view.rgb, text, column + across, row + down, size=13, color=BORDER, halo=2, anchor=anchor)
            return


LEGEND_PX = 640
"""Width of the legend (px)."""


def draw_legend(rgb: Image, left: int, top: int, goal: bool, arrival: bool = False, clusters: bool = True) -> None:
    """Draw two lines that explain the colours, in place, from (left, top) px, with the marks that are drawn."""
    squares = [
        (CELL_COLORS[0], "unexplored"),
        (CELL_COLORS[1], "explored"),
        (CELL_COLORS[2], "obstacle"),
        (CELL_COLORS[3], "oysters"),
    ]
    x, y = float(left), top + 12.0
    for color, name in squares:
        box = np.array([(x, y - 7), (x + 14, y - 7), (x + 14, y + 7), (x, y + 7)])
        cv2.fillPoly(rgb, [np.rint(box).astype(np.int32)], tuple(int(c) for c in color))
        cv2.polylines(rgb, [np.rint(box).astype(np.int32)], True, (110, 114, 122), 1)
        draw_text(rgb, name, x + 20, y, size=13)
        x += 20 + text_size(name, 13)[0] + 18
    draw_line(rgb, np.array([(x, y), (x + 22, y)]), YELLOW, 3, edge=YELLOW_EDGE)
    draw_text(rgb, "path travelled", x + 30, y, size=13)
    x, y = float(left), y + 24
    if clusters:
        draw_line(rgb, np.array([(x, y), (x + 26, y)]), BLUE, 2)
        draw_dot(rgb, np.array([x + 7, y]), 5, ORANGE, edge_width=1)
        draw_dot(rgb, np.array([x + 21, y]), 5, ORANGE, edge_width=1)
        draw_dot(rgb, np.array([x + 21, y]), 3.4, (255, 255, 255), edge=(255, 255, 255), edge_width=0)
        draw_text(rgb, "chain (hollow: done)", x + 34, y, size=13)
        x += 34 + text_size("chain (hollow: done)", 13)[0] + 14
    draw_dot(rgb, np.array([x + 6, y]), 5, RED, edge_width=0)
    draw_text(rgb, "robot", x + 16, y, size=13)
    x += 16 + text_size("robot", 13)[0] + 14
    if arrival:
        draw_dot(rgb, np.array([x + 6, y]), 5, RED, edge_width=0)
        draw_dot(rgb, np.array([x + 6, y]), 3, (255, 255, 255), edge=(255, 255, 255), edge_width=0)
        draw_text(rgb, "then", x + 16, y, size=13)
        x += 16 + text_size("then", 13)[0] + 14
    for color, name in ((RED, "+X forward"), (BLUE, "+Y left")):
        draw_arrow(rgb, np.array([x, y]), np.array([x + 22, y]), color, 2)
        draw_text(rgb, name, x + 28, y, size=13)
        x += 28 + text_size(name, 13)[0] + 14
    if goal:
        cv2.circle(rgb, (round(x + 8), round(y)), 6, MAGENTA, 2, cv2.LINE_AA)
        draw_text(rgb, "goal", x + 20, y, size=13)
