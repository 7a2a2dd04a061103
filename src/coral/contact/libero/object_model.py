"""The model of a LIBERO object: its collision boxes, and the named box regions of goals."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from coral.contact.scene.geometry import rotation_of
from coral.contact.scene.observation import Array
from coral.contact.scene.trial import box_corners
from coral.errors import InputError
from coral.foreign_file import read_text


@dataclass(frozen=True)
class Box:
    """A box in its object's frame."""

    position: Array
    """Centre, Shape=(3,) m."""
    rotation: Array
    """Rotation of its axes, Shape=(3, 3)."""
    size: Array
    """Full edges, Shape=(3,) m."""

    @property
    def corners(self) -> Array:
        """Return the corners, Shape=(8, 3)."""
        return np.asarray(box_corners(self.size) @ self.rotation.T + self.position)

    def turned(self, rotation: Array) -> Box:
        """Rotate the box about its object's origin by `rotation`, Shape=(3, 3)."""
        return Box(rotation @ self.position, rotation @ self.rotation, self.size)

    def contains(self, points: Array) -> NDArray[np.bool_]:
        """Check which points, Shape=(n, 3), lie inside; Shape=(n,)."""
        own = np.abs((points - self.position) @ self.rotation)
        return np.asarray(np.all(own <= self.size / 2, axis=1))


@dataclass(frozen=True)
class Model:
    """An object."""

    boxes: tuple[Box, ...]
    """Collision boxes."""
    regions: dict[str, Box]
    """Regions by name."""
    mass_kg: float
    """Mass of the boxes at their densities; overlaps count twice, as in MuJoCo."""
    friction: float
    """Sliding friction of its first box."""


def read_model(path: Path) -> Model:
    """Read an object's MuJoCo file, without its visual geoms (group 1).

    Raises:
        InputError: The file cannot be read, or a collision geom is not a box.
    """
    try:
        root = ElementTree.fromstring(read_text(path, "an object's MuJoCo file"))
    except ElementTree.ParseError as error:
        raise InputError(str(path), "", type(error).__name__, "a MuJoCo model") from None
    body = root.find(".//body[@name='object']")
    if body is None:
        raise InputError(str(path), "body", "none named object", "a model of LIBERO")
    geoms = [geom for geom in body.iter("geom") if geom.get("contype") != "0" and geom.get("group") != "1"]
    wrong = next((geom.get("type", "sphere") for geom in geoms if geom.get("type") != "box"), None)
    if wrong or not geoms:
        raise InputError(str(path), "geom", wrong or "none", "boxes that touch")
    boxes = tuple(_box(geom, str(path)) for geom in geoms)
    mass = sum(
        float(np.prod(box.size)) * _number(geom, "density", 1000.0, str(path))
        for geom, box in zip(geoms, boxes, strict=True)
    )
    regions = {str(site.get("name")): _box(site, str(path)) for site in body.iter("site") if site.get("type") == "box"}
    return Model(boxes, regions, mass, _number(geoms[0], "friction", 1.0, str(path)))


def _box(element: ElementTree.Element, where: str) -> Box:
    half = _numbers(element, "size", "", 3, where)
    quaternion = _numbers(element, "quat", "1 0 0 0", 4, where)
    if half.min() <= 0 or np.linalg.norm(quaternion) == 0:
        raise InputError(where, element.tag, ElementTree.tostring(element, "unicode").strip()[:80], "a box")
    # MuJoCo normalises quaternions, and LIBERO relies on it.
    rotation = rotation_of(quaternion / np.linalg.norm(quaternion))
    return Box(_numbers(element, "pos", "0 0 0", 3, where), rotation, 2 * half)


def _numbers(element: ElementTree.Element, key: str, default: str, count: int, where: str) -> Array:
    text = element.get(key, default)
    try:
        numbers = np.array([float(word) for word in text.split()])
    except ValueError:
        numbers = np.zeros(0)
    if len(numbers) != count or not np.isfinite(numbers).all():
        raise InputError(where, f"{element.tag}.{key}", repr(text), f"{count} numbers")
    return numbers


def _number(element: ElementTree.Element, key: str, default: float, where: str) -> float:
    text = element.get(key)
    try:
        return default if text is None else float(text.split()[0])
    except (ValueError, IndexError):
        raise InputError(where, f"{element.tag}.{key}", repr(text), "a number") from None
