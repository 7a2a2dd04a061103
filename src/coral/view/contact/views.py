"""Orthographic drawings of a contact run: the paths from three sides, and the contact points on each object."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.contact.scene.geometry import rotation_of
from coral.contact.scene.trial import Trial, corners
from coral.view.contact.figures import HUES
from coral.view.run import RunFolder
from coral.view.svg import line, text

Array = NDArray[np.float64]
PANEL = 340.0
"""Width of one of three views (px); the drawing is as wide as a chart."""
SIDES = (("from above", 0, 1), ("from the right", 0, 2), ("from the robot", 1, 2))
"""Name, axis to the right, axis upwards."""


@dataclass(frozen=True)
class ViewPanel:
    """One view: metres to pixels."""

    left: float
    top: float
    scale: float
    low: Array
    across: int
    up: int
    height: float

    def __call__(self, points: Array) -> Array:
        """Convert points, Shape=(n, 3) m, to pixels, Shape=(n, 2)."""
        x = self.left + (points[:, self.across] - self.low[self.across]) * self.scale
        y = self.top + self.height - (points[:, self.up] - self.low[self.up]) * self.scale
        return np.stack([x, y], axis=1)


def three_views(run: RunFolder, trial: Trial) -> str:
    """Draw the paths of tool and objects, with the objects' first and last poses, from above and from two sides."""
    paths = {"tool": _path(run, ""), **{name: _path(run, f"{name}_") for name in trial.objects}}
    paths = {name: points for name, points in paths.items() if len(points)}
    if not paths:
        return ""
    shapes = {name: [_outline(run, trial, name, row) for row in (0, -1)] for name in trial.objects if name in paths}
    places = [np.asarray(place)[None] for place in trial.task.places.values()]
    outlines = [points for pair in shapes.values() for points in pair]
    everything = np.concatenate([*paths.values(), *outlines, *places, np.zeros((1, 3))])
    low, high = everything.min(axis=0) - 0.03, everything.max(axis=0) + 0.03
    low, high = np.maximum(low, -1.0), np.minimum(high, 1.0)
    scale = min(PANEL / max(high[0] - low[0], 1e-3), PANEL / max(high[1] - low[1], 1e-3), 900.0)
    heights = [(high[up] - low[up]) * scale for _, _, up in SIDES]
    body, total = [], max(heights) + 64
    for k, (name, across, up) in enumerate(SIDES):
        panel = ViewPanel(10 + k * (PANEL + 30), 34, scale, low, across, up, max(heights))
        body.append(text(panel.left, 20, name, "mark", "start"))
        if up == 2:
            ground = panel(np.array([[low[0], low[1], 0.0], [high[0], high[1], 0.0]]))
            body.append(line(ground[0, 0], ground[0, 1], ground[1, 0], ground[1, 1], "axis"))
        for fixture in trial.task.fixtures:
            half = np.asarray(fixture.size) / 2
            body.append(_polygon(_hull(panel(_box(half) + np.asarray(fixture.position))), "#8a95a1", 0.35))
        for row, place in enumerate(trial.task.places.values()):
            x, y = panel(np.asarray(place, float)[None])[0]
            body.append(
                f'<path d="M{x - 5:.1f},{y:.1f}h10m-5,-5v10" style="stroke:#be00aa;stroke-width:2"><title>'
                f"{list(trial.task.places)[row]}</title></path>"
            )
        for number, (thing, points) in enumerate(paths.items()):
            hue = HUES[number % len(HUES)]
            for opacity, outline in zip((0.12, 0.3), shapes.get(thing, ()), strict=False):
                body.append(_polygon(_hull(panel(outline)), hue, opacity))
            body.append(_polyline(panel(points), hue))
            if k == 0:
                x = 10 + 110 * number
                body += [
                    f'<rect x="{x}" y="{total - 16:.1f}" width="12" height="4" style="fill:{hue}"/>',
                    text(x + 18, total - 10, thing, "tick", "start"),
                ]
        bar = 0.1 * scale
        end = panel.left + PANEL
        body += [line(end - bar, total - 12, end, total - 12, "axis"), text(end - bar / 2, total - 16, "10 cm", "tick")]
    return _svg(body, total, "Paths of the tool and the objects from three sides")


def touch_views(run: RunFolder, trial: Trial, name: str) -> str:
    """Draw the hand's contact points on an object, in the object's frame, from three sides; "" if there are none."""
    points = np.stack([run.column(f"{name}_touch_{axis}") for axis in "xyz"], axis=1)
    force = run.column(f"{name}_hand_force")
    touched = np.isfinite(points).all(axis=1)
    if not touched.any():
        return ""
    points, force = points[touched], force[touched]
    keep = np.unique(np.linspace(0, len(points) - 1, 240).astype(int))
    points, force = points[keep], force[keep]
    hull = corners(trial.task.object(name), trial.objects[name].scale)
    low, high = np.minimum(hull.min(axis=0), points.min(axis=0)), np.maximum(hull.max(axis=0), points.max(axis=0))
    scale = min(200.0 / max(float(v), 1e-3) for v in high - low)
    height = max((high[up] - low[up]) * scale for _, _, up in SIDES)
    body = []
    for k, (_, across, up) in enumerate(SIDES):
        panel = ViewPanel(40 + k * (PANEL + 30), 34, scale, low, across, up, height)
        body.append(text(panel.left, 20, f"its {'xyz'[across]} – {'xyz'[up]} plane", "mark", "start"))
        body.append(_polygon(_hull(panel(hull)), "#8a95a1", 0.25))
        for (x, y), newtons, share in zip(panel(points), force, np.linspace(0, 1, len(points)), strict=True):
            radius = 1.8 + 0.25 * min(float(newtons), 30.0) ** 0.7
            body.append(
                f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}" style="fill:{_ramp(float(share))};'
                f'fill-opacity:.55"/>'
            )
    return _svg(body, height + 50, f"Contact points on the {name}")


def _path(run: RunFolder, prefix: str) -> Array:
    points = np.stack([run.column(f"{prefix}{axis}") for axis in "xyz"], axis=1)
    points = points[np.isfinite(points).all(axis=1)]
    return points[np.unique(np.linspace(0, len(points) - 1, 400).astype(int))] if len(points) else points


def _outline(run: RunFolder, trial: Trial, name: str, row: int) -> Array:
    """Return the object's corners at a row of the trajectory."""
    pose = np.array([run.column(f"{name}_{part}")[row] for part in ("x", "y", "z", "qw", "qx", "qy", "qz")])
    return np.asarray(trial.corners(name) @ rotation_of(pose[3:]).T + pose[:3])


def _box(half: Array) -> Array:
    return np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T * half


def _hull(points: Array) -> Array:
    return np.asarray(cv2.convexHull(points.astype(np.float32))[:, 0], np.float64)


def _polygon(points: Array, hue: str, opacity: float) -> str:
    spots = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return f'<polygon points="{spots}" style="fill:{hue};fill-opacity:{opacity};stroke:{hue};stroke-opacity:.7"/>'


def _polyline(points: Array, hue: str) -> str:
    spots = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    (x0, y0), (x1, y1) = points[0], points[-1]
    return (
        f'<polyline points="{spots}" style="fill:none;stroke:{hue};stroke-width:2"/>'
        f'<circle cx="{x0:.1f}" cy="{y0:.1f}" r="3" style="fill:#fff;stroke:{hue};stroke-width:2"/>'
        f'<circle cx="{x1:.1f}" cy="{y1:.1f}" r="4" style="fill:{hue}"/>'
    )


def _ramp(share: float) -> str:
    """Colour samples by time: early is blue, late is red."""
    early, late = np.array([25, 90, 230]), np.array([200, 53, 43])
    red, green, blue = np.rint(early + share * (late - early)).astype(int)
    return f"#{red:02x}{green:02x}{blue:02x}"


def _svg(body: Sequence[str], height: float, label: str) -> str:
    return f'<svg viewBox="0 0 1100 {height:.0f}" class="chart" role="img" aria-label="{label}">{"".join(body)}</svg>'
