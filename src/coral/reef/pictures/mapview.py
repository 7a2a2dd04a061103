"""The picture of a survey map, in the paper's colour code, for advisors and for people (CORAL III-A, appendix)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.drawing import Image, draw_arrow, draw_dot, draw_line, draw_text, png, text_size
from coral.reef.pictures.cameraview import camera_picture
from coral.reef.pictures.mapframe import (
    BLUE,
    CELL_COLORS,
    FAR,
    LEGEND_PX,
    MAGENTA,
    MARK,
    ORANGE,
    PALE,
    RED,
    YELLOW,
    YELLOW_EDGE,
    MapPicture,
    draw_axes,
    draw_border,
    draw_legend,
    draw_scale_bar,
)
from coral.reef.world.geometry import Pose

__all__ = ["CELL_COLORS", "MapPicture", "MapScene", "camera_picture", "draw_map", "png"]

Box = tuple[float, float, float, float]
MARGIN_M = 1.5
"""Shown about the explored area."""
MIN_SIDE_M = 10.0
"""Minimum side of what is shown, so that the first pictures of a mission keep a sense of scale."""
LEFT_PX, RIGHT_PX, TOP_PX, BOTTOM_PX = 40, 12, 22, 30
"""Of the axes."""
ARROWS_M, ARROWS_PX = 1.5, 84
"""Least length of the arrows +X and +Y with their names; on a large map their pixels are more."""
HATCH_PX, HATCH = 9, (178, 182, 188)
_CELL_WORDS = np.ascontiguousarray(np.pad(CELL_COLORS, ((0, 0), (0, 1)))).view(np.uint32)[:, 0]


@dataclass(frozen=True, kw_only=True)
class MapScene:
    """The content of a map picture; world frame ENU, metres.

    Everything here is the robot's own estimate: pictures of it may go to an advisor.
    """

    cells: NDArray[np.uint8]
    """Shape=(H, W): 0 unexplored, 1 explored free, 2 obstacle, 3 oyster; row 0 is the smallest y, from 0."""
    cell_m: float
    floor: Image | None = None
    """The floor from above, drawn in place of the classes: a whole number of pixels to a cell, row 0 in the south.
    Shape=(K H, K W, 3)."""
    pose: Pose | None = None
    trajectory: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2)))
    """Shape=(N, 2), oldest first."""
    centroids: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2)))
    """Shape=(K, 2)."""
    indices: Sequence[int] | None = None
    """Label of each centroid; None labels them 0, 1, 2, ..."""
    visited: Sequence[bool] | None = None
    """Whether the robot has been at each centroid; None means none has been visited."""
    doubtful: Sequence[bool] = ()
    """Whether most pictures show seabed at each centroid; empty: at none."""
    idle: NDArray[np.bool_] | None = None
    """Unexplored cells that are not worth a visit, hatched like all beyond the border, Shape=(H, W); None: unknown."""
    clusters: bool = True
    """Whether the robot extracts clusters at all; without them the legend does not name them."""
    links: Sequence[tuple[int, int]] | None = None
    """Pairs of rows of `centroids` that blue lines join: a chain that forks; None joins them as they stand."""
    seen: Sequence[float | None] | None = None
    """Share of each cluster that has been seen from near, written beside it; None for one that is known from afar."""
    arrival: Pose | None = None
    """Where the robot will be when the answer is needed; None: where it is."""
    border: tuple[float, float, float, float] | None = None
    """(x0, y0, x1, y1) of the survey area (m)."""
    goal: tuple[float, float] | None = None
    marks: Sequence[tuple[float, float, str]] = ()
    """Places (m) and words of what the advisor of a mission in words said of things."""


def draw_map(scene: MapScene, *, size_px: int = 768, window: Box | None = None, legend: bool = True) -> MapPicture:
    """Draw the map as the paper shows it (CORAL III-A and prompts A and B).

    White is unexplored, gray explored free space, black obstacles, green oysters; orange dots are cluster
    centroids with their labels, hollow when nothing is left to see of them, joined by blue lines along the chain; the
    yellow line is where the robot has been; the red dot and arrow are the robot and its +X (forward), the blue arrow
    its +Y (left); hollow, with the arrows, where it will be when it needs the answer; the
    magenta cross-hair is the present goal.

    `size_px` is the longer side: providers scale larger pictures down to about 768. `window` is what is shown,
    (x0, y0, x1, y1) in metres; None: the explored area with a margin.
    """
    left, right, top, bottom = LEFT_PX, RIGHT_PX, TOP_PX, BOTTOM_PX
    legend_px, arrows_m = 54 if legend else 0, ARROWS_M
    for _ in range(3):  # more room for arrows makes the scale smaller
        shown = x0, y0, x1, y1 = window or _window(scene, arrows_m)
        scale = min((size_px - left - right) / (x1 - x0), (size_px - top - bottom - legend_px) / (y1 - y0))
        arrows_m = max(arrows_m, ARROWS_PX / scale - MARGIN_M)
    inner_w, inner_h = round(scale * (x1 - x0)), round(scale * (y1 - y0))
    # The legend needs its width even if the map is a narrow upright strip.
    width = max(inner_w + left + right, LEGEND_PX if legend else 0)
    rgb = np.full((inner_h + bottom + top + legend_px, width, 3), 255, np.uint8)
    view = MapPicture(rgb, scale, left - scale * x0, top + inner_h + scale * y0, shown)
    inner = rgb[top : top + inner_h, left : left + inner_w]
    inner[:] = _ground(scene, shown, inner_w, inner_h)
    if scene.idle is not None and scene.floor is None:
        _hatch(inner, scene.idle, _cells_of(scene, shown))
    # Overlays are clipped to the map by drawing into its slice.
    inside = MapPicture(inner, scale, -scale * x0, inner_h + scale * y0, shown)
    draw_scale_bar(inside)
    _draw_overlays(inside, scene)
    draw_axes(view, left, top, inner_w, inner_h)
    if legend:
        marks = {"goal": scene.goal is not None, "arrival": scene.arrival is not None, "clusters": scene.clusters}
        draw_legend(rgb, left, top + inner_h + bottom, **marks)
    return view


def _window(scene: MapScene, arrows_m: float) -> Box:
    height, width = scene.cells.shape
    whole = (0.0, 0.0, width * scene.cell_m, height * scene.cell_m)
    rows, columns = np.nonzero(scene.cells.any(axis=1))[0], np.nonzero(scene.cells.any(axis=0))[0]
    xs = [scene.cell_m * c for c in (columns[:1].tolist() + [i + 1 for i in columns[-1:].tolist()])]
    ys = [scene.cell_m * r for r in (rows[:1].tolist() + [i + 1 for i in rows[-1:].tolist()])]
    extra = [scene.trajectory, scene.centroids]
    extra += [_with_arrows(pose, arrows_m) for pose in (scene.pose, scene.arrival) if pose is not None]
    extra += [np.array([scene.goal])] if scene.goal is not None else []
    points = np.concatenate([np.asarray(part, np.float64).reshape(-1, 2) for part in extra])
    if len(points):
        xs += [points[:, 0].min(), points[:, 0].max()]
        ys += [points[:, 1].min(), points[:, 1].max()]
    if not xs:
        return whole
    # Where the border is drawn, the picture goes on beyond it: arrows fit in, and the end of the area is seen as such.
    beyond = MARGIN_M + arrows_m if scene.border is not None else 0.0
    low, high = (whole[0] - beyond, whole[1] - beyond), (whole[2] + beyond, whole[3] + beyond)
    x0, x1 = _span(min(xs) - MARGIN_M, max(xs) + MARGIN_M, MIN_SIDE_M, low[0], high[0])
    y0, y1 = _span(min(ys) - MARGIN_M, max(ys) + MARGIN_M, MIN_SIDE_M, low[1], high[1])
    # A picture longer than 3:2 wastes the pixels of an advisor's picture.
    side = max(x1 - x0, y1 - y0) / 1.5
    x0, x1 = _span(x0, x1, side, low[0], high[0])
    y0, y1 = _span(y0, y1, side, low[1], high[1])
    snap = scene.cell_m
    return (
        snap * math.floor(x0 / snap + 1e-6),
        snap * math.floor(y0 / snap + 1e-6),
        snap * math.ceil(x1 / snap - 1e-6),
        snap * math.ceil(y1 / snap - 1e-6),
    )


def _with_arrows(pose: Pose, arrows_m: float) -> NDArray[np.float64]:
    """Return a pose and about where its arrows end, with their names. Shape=(3, 2), metres."""
    c, s = arrows_m * math.cos(pose.theta), arrows_m * math.sin(pose.theta)
    return np.array([(pose.x, pose.y), (pose.x + c, pose.y + s), (pose.x - s, pose.y + c)])


def _span(low: float, high: float, least: float, floor: float, ceiling: float) -> tuple[float, float]:
    """Widen an interval to `least` and shift it inside [floor, ceiling]."""
    grow = max(0.0, least - (high - low)) / 2
    low, high = low - grow, high + grow
    low, high = (low - max(0.0, high - ceiling), min(high, ceiling))
    return max(low, floor), min(high + max(0.0, floor - low), ceiling)


def _cells_of(scene: MapScene, window: Box) -> tuple[int, int, int, int]:
    """Return the rows and columns (first, end, first, end) of the cells in a window."""
    c0, r0, c1, r1 = (round(edge / scene.cell_m) for edge in window)
    return r0, r1, c0, c1


def _hatch(rgb: Image, idle: NDArray[np.bool_], box: tuple[int, int, int, int]) -> None:
    """Hatch idle cells, and all that lies beyond the map, in place."""
    height, width = rgb.shape[:2]
    cut = _cut(idle.astype(np.uint8), box, 1)[::-1]
    mask = cv2.resize(cut, (width, height), interpolation=cv2.INTER_NEAREST) > 0
    rows, columns = np.ogrid[:height, :width]
    rgb[mask & ((rows + columns) % HATCH_PX < 2)] = HATCH


def _ground(scene: MapScene, window: tuple[float, float, float, float], width: int, height: int) -> Image:
    """Colour the cells of the window, north up, Shape=(height, width, 3)."""
    r0, r1, c0, c1 = _cells_of(scene, window)
    if scene.floor is not None:
        k = scene.floor.shape[0] // scene.cells.shape[0]
        floor = _cut(scene.floor, (k * r0, k * r1, k * c0, k * c1), 255)
        return np.asarray(cv2.resize(floor[::-1], (width, height), interpolation=cv2.INTER_AREA), np.uint8)
    cells = _cut(scene.cells, (r0, r1, c0, c1), 0)
    zoom = min(width / cells.shape[1], height / cells.shape[0])
    if zoom >= 2:  # integer enlargement first keeps the edges of cells sharp; interpolation smooths the rest
        cells = np.repeat(np.repeat(cells, int(zoom), axis=0), int(zoom), axis=1)
    filter_ = cv2.INTER_LINEAR if zoom >= 1 else cv2.INTER_AREA
    # One four-byte look-up per cell is several times faster than one per channel.
    colored = _CELL_WORDS[cells[::-1]].view(np.uint8).reshape(*cells.shape, 4)
    return np.asarray(cv2.resize(colored, (width, height), interpolation=filter_)[..., :3], np.uint8)


def _cut(grid: NDArray[np.uint8], box: tuple[int, int, int, int], outside: int) -> NDArray[np.uint8]:
    """Return the rows and columns (first, end, first, end) of a grid, which may lie beyond it."""
    r0, r1, c0, c1 = box
    cut = np.full((max(1, r1 - r0), max(1, c1 - c0), *grid.shape[2:]), outside, np.uint8)
    have = grid[max(r0, 0) : min(r1, grid.shape[0]), max(c0, 0) : min(c1, grid.shape[1])]
    cut[max(-r0, 0) : max(-r0, 0) + have.shape[0], max(-c0, 0) : max(-c0, 0) + have.shape[1]] = have
    return cut


def _draw_overlays(view: MapPicture, scene: MapScene) -> None:
    rgb = view.rgb
    if scene.border is not None:
        draw_border(view, scene.border)
    draw_line(rgb, view.to_pixels(_thin(scene.trajectory, 1.5 / view.scale)), YELLOW, 3, edge=YELLOW_EDGE)
    dots = view.to_pixels(np.asarray(scene.centroids, np.float64).reshape(-1, 2))
    if scene.links is not None:
        for a, b in scene.links:
            draw_line(rgb, dots[[a, b]], BLUE, 2, edge=(255, 255, 255))
    else:
        draw_line(rgb, dots, BLUE, 2, edge=(255, 255, 255))
    if scene.goal is not None:
        _crosshair(rgb, view.to_pixels(np.array(scene.goal)))
    visited = scene.visited if scene.visited is not None else [False] * len(dots)
    shares = scene.seen if scene.seen is not None else [0.0] * len(dots)
    robot: NDArray[np.float64] | None = None
    if scene.pose is not None:
        robot = view.to_pixels(np.array(scene.pose[:2]))
        if scene.arrival is None:
            robot = _robot(rgb, robot, scene.pose.theta)
        else:
            forward = np.array([math.cos(scene.pose.theta), -math.sin(scene.pose.theta)])
            draw_arrow(rgb, robot, robot + 30 * forward, RED)
            draw_dot(rgb, robot, 8.0, RED)
            there = view.to_pixels(np.array(scene.arrival[:2]))
            robot = np.concatenate([robot[None], _robot(rgb, there, scene.arrival.theta)])
            draw_dot(rgb, there, 8.0, RED)
            draw_dot(rgb, there, 5.0, (255, 255, 255), edge=(255, 255, 255), edge_width=0.5)
    doubtful = scene.doubtful or [False] * len(dots)
    for dot, done, share, doubt in zip(dots, visited, shares, doubtful, strict=True):
        draw_dot(rgb, dot, 6.5 if scene.floor is None else 2.5, FAR if share is None else PALE if doubt else ORANGE)
        if done and scene.floor is None:
            draw_dot(rgb, dot, 4.5, (255, 255, 255), edge=(255, 255, 255), edge_width=0.5)
    if len(dots):
        names = [
            _name(index, share, shown=scene.seen is not None and not done) + ("!" if doubt else "")
            for index, share, done, doubt in zip(
                scene.indices or range(len(dots)), shares, visited, doubtful, strict=True
            )
        ]
        _draw_labels(rgb, dots, names, robot)
    for x, y, words in scene.marks:
        column, row = view.to_pixels(np.array((x, y)))
        draw_text(rgb, words, column, row + 17, size=14, color=MARK, weight=700, halo=3, anchor="mm")


def _name(index: int, share: float | None, shown: bool) -> str:
    """Return the label of a dot: with ? if known from afar only, and how much of it has been seen if that is shown."""
    if share is None:
        return f"{index}?"
    return f"{index} {round(100 * share)}%" if shown and 0.005 <= share < 0.995 else str(index)


def _thin(path: NDArray[np.float64], step: float) -> NDArray[np.float64]:
    """Drop the points of a path that lie within about `step` of the previous one, ends kept. Shape=(N, 2)."""
    path = np.asarray(path, np.float64).reshape(-1, 2)
    if len(path) < 3:
        return path
    travelled = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    keep = np.concatenate([[True], np.diff(np.floor(travelled / step)) > 0])
    keep[-1] = True
    thinned: NDArray[np.float64] = path[keep]
    return thinned


def _crosshair(rgb: Image, at: NDArray[np.float64]) -> None:
    for color, extra in (((255, 255, 255), 2), (MAGENTA, 0)):
        cv2.circle(rgb, (round(at[0]), round(at[1])), 13, color, 2 + extra, cv2.LINE_AA)
        for step in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            arm = np.array([at + 9 * np.array(step), at + 18 * np.array(step)], np.float64)
            draw_line(rgb, arm, color, 2 + extra)


def _robot(rgb: Image, at: NDArray[np.float64], theta: float) -> NDArray[np.float64]:
    forward = np.array([math.cos(theta), -math.sin(theta)])
    leftward = np.array([-math.sin(theta), -math.cos(theta)])
    draw_arrow(rgb, at, at + 46 * leftward, BLUE)
    draw_arrow(rgb, at, at + 56 * forward, RED)
    draw_dot(rgb, at, 8.0, RED)
    draw_text(rgb, "+Y", *(at + 62 * leftward), size=15, color=BLUE, weight=700, halo=2, anchor="mm")
    draw_text(rgb, "+X", *(at + 72 * forward), size=15, color=RED, weight=700, halo=2, anchor="mm")
    return np.array([at, at + 30 * forward, at + 72 * forward, at + 30 * leftward, at + 62 * leftward])


def _draw_labels(
    rgb: Image, dots: NDArray[np.float64], names: Sequence[str], robot: NDArray[np.float64] | None
) -> None:
    """Write each label beside its dot where it hides the fewest dots, labels and robot marks."""
    height, width = rgb.shape[:2]
    taken: list[Box] = [(x - 8, y - 8, x + 8, y + 8) for x, y in dots]
    if robot is not None:
        taken += [(x - 13, y - 11, x + 13, y + 11) for x, y in robot]
    for (x, y), name in zip(dots, names, strict=True):
        w, h = text_size(name, 17, 700, 3)
        if not (-10 <= x <= width + 10 and -10 <= y <= height + 10):
            continue
        reach_x, reach_y = 9 + w / 2, 6 + h / 2
        best, cost = (x, y), math.inf
        for rank, (dx, dy) in enumerate(
            ((0.9, -0.7), (-0.9, -0.7), (0.9, 0.7), (-0.9, 0.7), (0, -1), (1, 0), (-1, 0), (0, 1))
        ):
            cx = min(max(x + dx * reach_x, w / 2), width - w / 2)
            cy = min(max(y + dy * reach_y, h / 2), height - h / 2)
            box = (cx - w / 2, cy - h / 2 + 2, cx + w / 2, cy + h / 2 - 2)
            hidden = sum(_overlap(box, other) for other in taken)
            if hidden + rank < cost:
                best, cost = (cx, cy), hidden + rank
        draw_text(rgb, name, *best, size=17, color=(150, 62, 0), weight=700, halo=3, anchor="mm")
        taken.append((best[0] - w / 2, best[1] - h / 2, best[0] + w / 2, best[1] + h / 2))


def _overlap(a: Box, b: Box) -> float:
    """Compute the area shared by two boxes (x0, y0, x1, y1)."""
    return max(0.0, min(a[2], b[2]) - max(a[0], b[0])) * max(0.0, min(a[3], b[3]) - max(a[1], b[1]))
