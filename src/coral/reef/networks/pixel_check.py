"""Looks at a shipped picture whose truth is known: are channels and scaling those that a network was trained with?"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from coral.foreign_file import read_picture_file
from coral.reef.eyes.ground_plane import ground_depth
from coral.reef.networks.network_notes import SCALINGS, PictureInput
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Label

CAMERA = CameraCfg()
"""That took the picture."""
_FOLDER = Path(__file__).parent / "check_picture"
_CLEARLY = 0.1
"""Overlap by which another input must be better: networks that know no painted pictures differ by less, by chance."""
_TREND = 0.5
"""Correlation with the floor's inverse depth from which a map is one of depth."""

Look = Callable[[NDArray[np.uint8], PictureInput], NDArray[np.uint8]]
"""Classes of a picture, given to the network in some way. Shape=(H, W, 3) to (H, W)."""


@cache
def shipped_picture() -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Return a painted picture of oysters in clear water, red first, and its classes. Shape=(H, W, 3), (H, W)."""
    rgb, labels = (read_picture_file(_FOLDER / name) for name in ("rgb.jpg", "labels.png"))
    assert rgb is not None
    assert labels is not None
    return np.ascontiguousarray(rgb[:, :, ::-1]), np.asarray(labels, np.uint8)


def check_pixels(look: Look, used: PictureInput) -> str:
    """Return a line if the network finds the oysters of the shipped picture clearly better in another way; else ''."""
    rgb, truth = shipped_picture()
    others = [replace(used, bgr=not used.bgr), *(replace(one, bgr=used.bgr) for one in SCALINGS.values())]
    overlaps = {way: _overlap(look(rgb, way), truth) for way in dict.fromkeys([used, *others])}
    best = max(overlaps, key=overlaps.__getitem__)
    if overlaps[best] < overlaps[used] + _CLEARLY:
        return ""
    return (
        f"on the shipped picture it finds oysters better with {best.describe()} (IoU {overlaps[best]:.2f}) than with "
        f"{used.describe()} (IoU {overlaps[used]:.2f}): if it was trained so, state it"
    )


def depth_kind(values: NDArray[np.float32]) -> str:
    """Say what a map of the shipped picture is: relative (larger is nearer), metric, or '' if neither."""
    _, truth = shipped_picture()
    ground = ground_depth(CAMERA)
    floor = (truth == Label.SEABED) & (ground < CAMERA.range_m) & np.isfinite(values)
    if floor.sum() < 2 or np.ptp(values[floor]) < 1e-9:
        return ""
    trend = float(np.corrcoef(values[floor], 1.0 / ground[floor])[0, 1])
    return "relative" if trend > _TREND else "metric" if trend < -_TREND else ""


def _overlap(labels: NDArray[np.uint8], truth: NDArray[np.uint8]) -> float:
    found, true = labels == Label.OYSTER, truth == Label.OYSTER
    return float((found & true).sum() / max((found | true).sum(), 1))
