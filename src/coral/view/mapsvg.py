"""The large map of a run report: the robot's map, track and decisions, with the truth drawn over it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.drawing import palette_png, png_url
from coral.reef.decide.said import said_by
from coral.reef.pictures.mapframe import CELL_COLORS, nice_step
from coral.reef.world.geometry import Label
from coral.reef.world.scene import RECTANGLE, Scene
from coral.reef.world.world import ReefWorld
from coral.view.decisions import Decision, chain_at
from coral.view.run import Record, RunFolder
from coral.words import clock

SIZE_PX = 760.0
"""Longer side of the map in its own pixels."""
PAD = (38.0, 12.0, 12.0, 30.0)
"""Margins for the axes: left, top, right, bottom (px)."""


FINISHED = (
    *("nothing left to explore", "the advisor ended the survey", "coverage complete", "the tour is done"),
    "all lanes are done",
)
"""Ends of a survey that was not cut short: what it has not covered then, it has missed."""
PASSED_M = 2.0
"""A cluster that the path came this near to and that is not covered was missed, however the survey ended."""


class MapSvg:
    """Draws one run's map; world metres to picture pixels, north up."""

    def __init__(self, run: RunFolder, size_m: tuple[float, float]) -> None:
        self.run, self.size_m = run, size_m
        self.scale = (SIZE_PX - PAD[0] - PAD[2]) / max(size_m)
        self.width = PAD[0] + PAD[2] + self.scale * size_m[0]
        self.height = PAD[1] + PAD[3] + self.scale * size_m[1]

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Return the picture pixel of a world point."""
        return PAD[0] + self.scale * x, PAD[1] + self.scale * (self.size_m[1] - y)

    def draw(self, made: Sequence[Decision]) -> str:
        """Return the SVG element at the end of the run."""
        left, top = self.at(0.0, self.size_m[1])
        w, h = self.scale * self.size_m[0], self.scale * self.size_m[1]
        last = self.run.frame_steps[-1] if self.run.frame_steps else None
        cells = self.run.frame(last, "map") if last is not None else None
        href = map_uri(cells) if cells is not None else ""
        truth, names = self._truth()
        return "".join(
            (
                f'<svg id="map" viewBox="0 0 {self.width:.0f} {self.height:.0f}" class="map" role="group" '
                f'aria-label="Map of the survey" data-scale="{self.scale:.6f}" data-x0="{left:.3f}" '
                f'data-y0="{top + h:.3f}"><defs><clipPath id="inside"><rect x="{left:.1f}" y="{top:.1f}" '
                f'width="{w:.1f}" height="{h:.1f}"/></clipPath></defs>',
                f'<rect x="{left:.1f}" y="{top:.1f}" width="{w:.1f}" height="{h:.1f}" class="sea"/>',
                f'<image id="cells" x="{left:.1f}" y="{top:.1f}" width="{w:.1f}" height="{h:.1f}" '
                f'preserveAspectRatio="none" href="{href}"/>'
                if href
                else "",
                '<g clip-path="url(#inside)">',
                truth,
                self._path(),
                self._centroids(),
                names,
                self._links(made),
                '<g id="goalmark" class="goal" visibility="hidden"><circle r="11"/>'
                '<path d="M-16,0h9M7,0h9M0,-16v9M0,7v9"/></g>',
                self._decisions(made),
                self._marks(),
                self._collisions(),
                self._robot(),
                "</g>",
                self._axes(),
                "</svg>",
            )
        )

    def _truth(self) -> tuple[str, str]:
        """Draw what is there, and above everything that would hide them, the names of its clusters."""
        parts = []
        for label, points in outlines(self.run.world):
            if label == Label.OBSTACLE:
                parts.append(f'<path d="{self._open_path(points)}Z" class="rock"/>')
        names = []
        for cluster in _records(self.run.world.get("clusters")):
            hull = cluster_outline(cluster)
            if not len(hull):
                continue
            name = str(cluster.get("name", ""))
            state, said = cluster_fate(self.run, cluster)
            parts.append(
                f'<path d="{self._open_path(hull)}Z" class="cluster {state}"><title>true cluster '
                f"{escape(name)}: {said}</title></path>"
            )
            low = hull[int(np.argmin(hull[:, 1]))]
            x, y = self.at(float(hull[:, 0].mean()), float(low[1]))
            mark = {"covered": "✓", "missed": "✗ missed"}.get(state, "not reached")
            names.append(text(x, min(y + 15, self.height - PAD[3] - 4), f"{name} {mark}", f"truthname {state}"))
        for thing in _records(self.run.world.get("things")):
            kind, name = str(thing.get("kind", "")).replace("-", " "), str(thing.get("name") or "")
            x, y = self.at(float(thing.get("x", 0)), float(thing.get("y", 0)))
            names.append(text(x, y + 4, f"{name} ({kind})" if name and name != kind else kind, "truthname thing"))
        return f'<g id="layer-truth">{"".join(parts)}</g>', f'<g id="layer-truenames">{"".join(names)}</g>'

    def _path(self) -> str:
        points = np.stack(track(self.run), axis=1)
        d = self._open_path(points)
        drawn = f'<path id="track-edge" d="{d}" class="track edge"/><path id="track" d="{d}" class="track"/>'
        return f'<g id="layer-path">{drawn if len(points) > 1 else ""}</g>'

    def _open_path(self, points: NDArray[np.float64]) -> str:
        return "M" + "L".join("{:.1f},{:.1f}".format(*self.at(float(x), float(y))) for x, y in points)

    def _centroids(self) -> str:
        last = chain_at(self.run, self.run.duration_s)
        spots = [self.at(float(c["x"]), float(c["y"])) for c in last]
        chain = " ".join(f"{x:.1f},{y:.1f}" for x, y in spots)
        dots = "".join(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="6" class="centroid{" visited" if c.get("visited") else ""}"/>'
            f"{text(x + 10, y - 7, str(c['index']), 'centroidname', 'start')}"
            for (x, y), c in zip(spots, last, strict=True)
        )
        return f'<g id="layer-centroids"><polyline points="{chain}" class="chain"/>{dots}</g>'

    def _links(self, made: Sequence[Decision]) -> str:
        links = [(d, self.at(d.x, d.y), self.at(*d.goal)) for d in made if d.goal and math.isfinite(d.x)]
        lines = (
            f'<line x1="{a[0]:.1f}" y1="{a[1]:.1f}" x2="{b[0]:.1f}" y2="{b[1]:.1f}" class="link" '
            f'data-decision="{d.number}"/>'
            for d, a, b in links
        )
        return f'<g id="layer-links">{"".join(lines)}</g>'

    def _decisions(self, made: Sequence[Decision]) -> str:
        """Draw numbered markers at the positions of the questions, moved apart if they would overlap."""
        placed: list[tuple[float, float]] = []
        parts = []
        for d in made:
            if not math.isfinite(d.x):
                continue
            x0, y0 = self.at(d.x, d.y)
            x, y = x0, y0
            for k in range(1, 60):
                if all(math.hypot(x - a, y - b) >= 19 for a, b in placed):
                    break
                # Golden-angle spiral: the nearest free place around the true one.
                radius, angle = 7.0 * math.sqrt(k), 2.399963 * k
                x, y = x0 + radius * math.cos(angle), y0 + radius * math.sin(angle)
            x = min(max(x, PAD[0] + 11), self.width - PAD[2] - 11)
            y = min(max(y, PAD[1] + 11), self.height - PAD[3] - 11)
            placed.append((x, y))
            lead = line(x0, y0, x, y, "lead") if math.hypot(x - x0, y - y0) > 4 else ""
            parts.append(
                f'<g class="decision {d.state}" data-decision="{d.number}" tabindex="0" role="button">{lead}'
                f'<circle cx="{x:.1f}" cy="{y:.1f}" r="9.5"/>{text(x, y + 3.8, str(d.number), "")}'
                f"<title>decision {d.number} at {clock(d.t)}: {escape(d.tries[-1].said)}</title></g>"
            )
        return f'<g id="layer-decisions">{"".join(parts)}</g>'

    def _marks(self) -> str:
        """Write beside things what the advisor of a mission in words said of them."""
        parts = []
        for one in said_by(self.run.events):
            x, y = self.at(one.x, one.y)
            name = text(x, y + 20, one.name, "markname skipped" if one.skip else "markname")
            parts.append(f"<g>{name}<title>{escape(one.why)}</title></g>")
        return f'<g id="layer-marks">{"".join(parts)}</g>'

    def _collisions(self) -> str:
        parts = []
        for event in self.run.select("collision"):
            x, y = self.at(float(event["x"]), float(event["y"]))
            parts.append(
                f'<path d="M{x - 7:.1f},{y - 7:.1f}l14,14m0,-14l-14,14" class="cross"><title>collision at '
                f"{clock(float(event['t']))}</title></path>"
            )
        return f'<g id="layer-collisions">{"".join(parts)}</g>'

    def _robot(self) -> str:
        xs, ys, thetas = (self.run.column(name) for name in ("x", "y", "theta"))
        if not len(xs):
            return ""
        x, y = self.at(float(xs[-1]), float(ys[-1]))
        turn = -math.degrees(float(thetas[-1])) if math.isfinite(thetas[-1]) else 0.0
        return (
            f'<g id="robot" transform="translate({x:.1f},{y:.1f}) rotate({turn:.1f})">'
            f'<circle r="{0.3 * self.scale:.1f}" class="hull"/>'
            '<path d="M0,0L0,-22" class="leftward"/><path d="M-4,-21L0,-30L4,-21Z" class="leftward tip"/>'
            '<path d="M0,0L28,0" class="forward"/><path d="M27,-5L38,0L27,5Z" class="forward tip"/>'
            '<circle r="6.5" class="body"/></g>'
        )

    def _axes(self) -> str:
        left, bottom = self.at(0.0, 0.0)
        right, top = self.at(*self.size_m)
        step = nice_step(max(self.size_m), 8)
        w, h = right - left, bottom - top
        parts = [f'<rect x="{left:.1f}" y="{top:.1f}" width="{w:.1f}" height="{h:.1f}" class="frame"/>']
        for k in range(int(self.size_m[0] / step + 1e-9) + 1):
            x = self.at(k * step, 0.0)[0]
            parts += [line(x, bottom, x, bottom + 4, "axis"), text(x, bottom + 17, f"{k * step:g}", "tick")]
        for k in range(int(self.size_m[1] / step + 1e-9) + 1):
            y = self.at(0.0, k * step)[1]
            parts += [line(left - 4, y, left, y, "axis"), text(left - 7, y + 4, f"{k * step:g}", "tick", "end")]
        parts.append(text((left + right) / 2, bottom + 28, "east, m", "tick"))
        parts.append(
            f'<text transform="translate(11,{(top + bottom) / 2:.1f}) rotate(-90)" text-anchor="middle" '
            'class="tick">north, m</text>'
        )
        return "".join(parts)


def text(x: float, y: float, words: str, cls: str = "", anchor: str = "middle") -> str:
    """Draw a label; `cls` names its style in the page."""
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" class="{cls}">{escape(words)}</text>'


def line(x1: float, y1: float, x2: float, y2: float, cls: str) -> str:
    """Draw a straight line."""
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" class="{cls}"/>'


def map_uri(cells: NDArray[Any]) -> str:
    """Return the data URL of a small picture of map cells, Shape=(H, W) with row 0 at the smallest y."""
    classes = np.minimum(cells[::-1], len(CELL_COLORS) - 1).astype(np.uint8)
    return png_url(palette_png(classes, CELL_COLORS))


def track(run: RunFolder, points: int = 1500) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return positions along the run, thinned to about `points`; two arrays of Shape=(M,) (m)."""
    x, y = run.column("x"), run.column("y")
    ok = np.isfinite(x) & np.isfinite(y)
    x, y = x[ok], y[ok]
    keep = np.unique(np.append(np.arange(0, len(x), max(1, -(-len(x) // points))), max(len(x) - 1, 0)))
    return (x[keep], y[keep]) if len(x) else (x, y)


def cluster_fate(run: RunFolder, cluster: Record) -> tuple[str, str]:
    """Return what became of a true cluster, "covered", "missed" or "unreached", and the same in words."""
    name = str(cluster.get("name", ""))
    covered_s = [float(e["t"]) for e in run.select("cluster_covered") if str(e.get("name")) == name]
    if covered_s:
        return "covered", f"covered at {clock(covered_s[-1])}"
    reason = str((run.select("end") or [{}])[-1].get("reason") or "the run was interrupted")
    middle = cluster_outline(cluster).mean(axis=0)
    passed = (np.hypot(*(np.stack(track(run), axis=1) - middle).T) < PASSED_M).any()
    if passed or reason.startswith(FINISHED):
        return "missed", "missed"
    return "unreached", f"not reached, {reason}"


def cluster_outline(cluster: Record) -> NDArray[np.float64]:
    """Return the convex outline of a cluster's oysters, Shape=(M, 2) m; empty without any."""
    points = []
    for oyster in _records(cluster.get("oysters")):
        x, y = float(oyster.get("x", 0)), float(oyster.get("y", 0))
        radius = max((float(r) for r in oyster.get("radii") or ()), default=0.1) + 0.1
        points += [(x + radius * math.cos(k * math.pi / 4), y + radius * math.sin(k * math.pi / 4)) for k in range(8)]
    if not points:
        return np.zeros((0, 2))
    return np.asarray(cv2.convexHull(np.array(points, np.float32))[:, 0], np.float64)


def outlines(world: Record) -> list[tuple[Label, NDArray[np.float64]]]:
    """Return `solid_outlines` of the content of a world file; none where it is no reef."""
    try:
        return solid_outlines(ReefWorld.model_validate(world))
    except ValueError:
        return []


def solid_outlines(world: ReefWorld) -> list[tuple[Label, NDArray[np.float64]]]:
    """Return what each solid of a reef is, and its closed outline on the sea floor, Shape=(M, 2) m."""
    scene = Scene.from_world(world)
    shapes = scene.outlines(np.arange(len(scene.kind)))
    angle = np.linspace(0.0, 2.0 * np.pi, 25)
    rim = np.stack([np.cos(angle), np.sin(angle)], 1)
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)], np.float64)
    found = []
    for k, label in enumerate(scene.label):
        c, s = np.cos(shapes.yaw[k]), np.sin(shapes.yaw[k])
        local = (corners if shapes.kind[k] == RECTANGLE else rim) * shapes.half[k]
        found.append((Label(label), shapes.center[k] + local @ np.array([[c, s], [-s, c]])))
    return found


def _records(value: object) -> list[Record]:
    return [item for item in value if isinstance(item, dict)] if isinstance(value, list | tuple) else []
