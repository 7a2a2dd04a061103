"""Eyes by name: exact, painted, rgb, or a file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError, nearest
from coral.onnx_file import open_picture_network
from coral.plugins import has_plugin, named_plugin, our_part
from coral.reef.eyes.perception import CameraAttitude, RgbPerception, SeenPicture
from coral.reef.eyes.reef_net import REAL, SHIPPED, ReefNetEyes
from coral.reef.vehicle.camera import CameraCfg

EXACT, PAINTED, RGB = "exact", "painted", "rgb"
_NETWORKS = {PAINTED: SHIPPED, RGB: REAL}
NEARER = 1.05
"""Largest distance to painted reefs over that to real pictures. Of the shipped network for real ones it is 0.72 to 0.93
in the pictures of missions, and 1.7 to 2.9 in frames of two videos; while it was trained, 1.02 at most and 1.07 at
least, the latter in videos that were left out."""

FAR = 1.2
"""Largest distance to painted reefs, in units of the network's limit: it is at most 1.02 in those pictures."""


def open_eyes(
    name: str, where: str = "--perception", *, depth: str = "", painted: bool = False
) -> RgbPerception | None:
    """Return eyes by name: exact, a network of the package, an entry point of the group `coral.eyes`, or an ONNX file.

    `painted` says that this package paints the pictures: then no network that it trained asks whether they are real.
    `depth` is the ONNX file of a relative depth network, which replaces the depth of the eyes; "" for none. None for
    exact: the simulator's frames are used as they are.

    Raises:
        InputError: There is no such thing, or the file has a layout that is not known.
    """
    if depth:
        eyes = open_eyes(name, where, painted=painted)
        if eyes is None:
            raise InputError(
                "--depth", "", f"{depth} beside {EXACT}", f"--perception {PAINTED}, {RGB} or FILE.onnx, for the classes"
            )
        with_depth: RgbPerception = our_part("networks", "depth", "--depth")(eyes, Path(depth))
        return with_depth
    if name == EXACT:
        return None
    if name == RGB and painted:
        raise InputError(
            where, "", f"{RGB}, for real pictures", f"{PAINTED}: a simulated camera's pictures are painted"
        )
    if name in _NETWORKS:
        shipped = ReefNetEyes(open_picture_network(_NETWORKS[name], where))
        if name == RGB or painted:
            return shipped
        return PaintedOnlyEyes(shipped, ReefNetEyes(open_picture_network(REAL, where)))
    made: RgbPerception
    if not name.endswith(".onnx") and has_plugin("coral.eyes", name):
        made = named_plugin("coral.eyes", name, where)()
        return made
    if not name.endswith(".onnx"):
        known = (EXACT, *_NETWORKS)
        raise InputError(where, "", repr(name), f"{', '.join(known)} or FILE.onnx{nearest(name, known)}")
    file = open_picture_network(Path(name), where)
    if file.input_shape[1] == 4 and "depth_doubt" in file.outputs:
        return ReefNetEyes(file, painted=painted)
    made = our_part("networks", "classes", where)(file)
    return made


class PaintedOnlyEyes:
    """Sees by the network for painted pictures; that for real ones, which knows both, tells what is painted."""

    def __init__(self, eyes: ReefNetEyes, real: ReefNetEyes) -> None:
        """Use the two networks."""
        self.about: tuple[str, ...] = eyes.about
        self._eyes, self._real = eyes, real

    def perceive(self, rgb: NDArray[np.uint8], camera: CameraCfg, attitude: CameraAttitude) -> SeenPicture:
        """Find classes and depth, and how far the picture is from painted ones."""
        from_real, from_painted = self._real.compare(rgb, camera, attitude)
        seen = self._eyes.perceive(rgb, camera, attitude)
        return replace(seen, unlike=max(from_painted / FAR, from_painted / max(NEARER * from_real, 1e-6)))
