"""The content of the live page at one moment: plain values that any application can provide."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from coral.view.pictures import RGB, Image

Tone = Literal["plain", "good", "bad"]
Layer = Literal["", "rollouts", "shapes", "truth"]
"""Layers that a checkbox hides; "" is always visible. "truth" is unknown to the robot."""


@dataclass(frozen=True, kw_only=True)
class Ground:
    """A map on the ground: a picture with some classes raised as simple shapes."""

    cells: NDArray[np.uint8]
    """Shape=(H, W) classes; row 0 is the smallest y."""
    palette: NDArray[np.uint8]
    """Shape=(C, 3) RGB of each class."""
    cell_m: float
    origin: tuple[float, float] = (0.0, 0.0)
    """World position (m) of the corner of cell [0, 0]."""
    grid_m: float = 1.0
    """Width of the grid's cells (m)."""
    heights: Mapping[int, tuple[float, RGB]] = field(default_factory=dict)
    """Height (m) and colour of the raised classes; a map contains no heights, so these are only illustrative."""


@dataclass(frozen=True, kw_only=True)
class Line:
    """Line segments of one colour."""

    name: str
    segments: NDArray[np.float32]
    """Shape=(S, 2, 3), metres."""
    color: RGB
    width_px: float = 2.0
    layer: Layer = ""


@dataclass(frozen=True, kw_only=True)
class Marker:
    """A labelled ball."""

    label: str
    position: tuple[float, float, float]
    color: RGB
    radius_m: float = 0.16


@dataclass(frozen=True, kw_only=True)
class LivePart:
    """One solid of a body, in the body's own frame (m)."""

    shape: Literal["box", "ball", "cylinder"]
    center: tuple[float, float, float]
    size: tuple[float, float, float]
    """Edges of a box; a ball has diameter size[0], an upright cylinder diameter size[0] and height size[2]."""
    color: RGB
    opacity: float = 1.0


@dataclass(frozen=True, kw_only=True)
class LiveBody:
    """A rigid moving thing, whose parts and lines never change."""

    name: str
    parts: tuple[LivePart, ...]
    lines: tuple[Line, ...] = ()
    """Lines in the body's own frame."""
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    wxyz: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class Number:
    """One value at the head of the page."""

    name: str
    value: str
    tone: Tone = "plain"


@dataclass(frozen=True, kw_only=True)
class Asked:
    """An open question."""

    title: str
    mode: str
    since_s: float
    attempt: int = 0
    cause: str = ""


@dataclass(frozen=True, kw_only=True)
class Answered:
    """The last verdict on an answer."""

    verdict: str
    said: str
    at_s: float
    reason: str = ""
    """Reason of a refusal, or the advisor's reason for its choice."""


@dataclass(frozen=True, kw_only=True)
class Chart:
    """Curves over simulated time."""

    title: str
    names: tuple[str, ...]
    t: NDArray[np.float64]
    """Times, Shape=(N,), s."""
    values: NDArray[np.float64]
    """Values, Shape=(len(names), N)."""
    colors: tuple[RGB, ...]
    bounds: tuple[float, float] | None = None
    """Bounds of the vertical axis; None fits the curves."""


@dataclass(frozen=True, kw_only=True)
class LiveState:
    """One moment of a run: complete and immutable."""

    title: str
    about: str = ""
    """One line: advisor, variant, seed."""
    status: str = "running"
    t: float = 0.0
    """Simulated time (s)."""
    until_s: float = 0.0
    """End of the run (s); 0 if unknown."""
    curves_s: float = 0.0
    """End of the charts' time axis (s); 0: `until_s`."""
    numbers: tuple[Number, ...] = ()
    asked: Asked | None = None
    answered: Answered | None = None
    log: tuple[str, ...] = ()
    """Latest events, newest first."""
    ground: Ground | None = None
    lines: tuple[Line, ...] = ()
    markers: tuple[Marker, ...] = ()
    bodies: tuple[LiveBody, ...] = ()
    view: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None
    """Where a new browser's camera is and where it looks (m); None looks at the whole ground from the south."""
    follow: str = ""
    """Name of the body that the camera may follow."""
    pictures: tuple[tuple[str, Image], ...] = ()
    """(name, RGB picture)."""
    charts: tuple[Chart, ...] = ()
    legend: tuple[tuple[RGB, str], ...] = ()
    note: str = ""
    """A line for the operator: what the page cannot show, or what it waits for."""
