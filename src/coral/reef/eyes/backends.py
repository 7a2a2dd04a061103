"""Eyes by name: exact, painted, rgb, or a file."""

from __future__ import annotations

from copy import copy
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError, nearest
from coral.onnx_file import open_picture_network
from coral.plugins import has_plugin, named_plugin
from coral.reef.eyes.network_notes import SUFFIX, read_notes
from coral.reef.eyes.perception import CameraAttitude, RgbPerception
from coral.reef.eyes.picture_input import PictureInput
from coral.reef.eyes.pixel_check import CAMERA, check_pixels
from coral.reef.eyes.reef_net import OUTPUTS, REAL, SHIPPED, ReefNetEyes
from coral.reef.eyes.relative_depth import DepthAnything, RelativeDepthEyes, is_depth
from coral.reef.eyes.semantic_map import SemanticEyes
from coral.reef.eyes.yolo_eyes import YoloEyes, is_yolo

EXACT, PAINTED, RGB = "exact", "painted", "rgb"
_NETWORKS = {PAINTED: SHIPPED, RGB: REAL}


def open_eyes(
    name: str, where: str = "--perception", *, depth: str = "", painted: bool = False
) -> RgbPerception | None:
    """Return eyes by name: exact, a network of the package, an entry point of the group `coral.eyes`, or an ONNX file.

    `painted` says that this package paints the pictures: then no network that it trained finds them unlike real ones.
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
        return RelativeDepthEyes(eyes, DepthAnything(open_picture_network(Path(depth), "--depth")))
    if name == EXACT:
        return None
    if name == RGB and painted:
        raise InputError(
            where, "", f"{RGB}, for real pictures", f"{PAINTED}: a simulated camera's pictures are painted"
        )
    if name in _NETWORKS:
        return ReefNetEyes(open_picture_network(_NETWORKS[name], where))
    if not name.endswith(".onnx") and has_plugin("coral.eyes", name):
        made: RgbPerception = named_plugin("coral.eyes", name, where)()
        return made
    if not name.endswith(".onnx"):
        known = (EXACT, *_NETWORKS)
        raise InputError(where, "", repr(name), f"{', '.join(known)} or FILE.onnx{nearest(name, known)}")
    file = open_picture_network(Path(name), where)
    if file.input_shape[1] == 4 and "depth_doubt" in file.outputs:
        return ReefNetEyes(file, painted=painted)
    if file.input_shape[1] not in (3, None):
        found = f"{file.input_shape[1]} channels"
        raise InputError(file.path, "inputs", found, f"3, a picture, or 4 with outputs {', '.join(OUTPUTS)}")
    notes = read_notes(file)
    if notes.task not in ("", "segment", "semantic"):
        raise InputError(file.path, "metadata.task", notes.task, "segment: outlines, not boxes alone")
    if is_depth(file):
        only = next(iter(file.outputs))
        raise InputError(file.path, "outputs", f"{only} alone", "classes; for depth give this file to --depth")
    eyes = YoloEyes(file, notes) if is_yolo(file) else SemanticEyes(file, notes)
    if notes.stated.channels is None and notes.stated.pixels is None:
        told = check_pixels(partial(_labels, eyes), eyes.pixels)
        eyes.about += (f"{told} in {Path(file.path).with_suffix(SUFFIX).name}",) if told else ()
    return eyes


def _labels(eyes: YoloEyes | SemanticEyes, rgb: NDArray[np.uint8], pixels: PictureInput) -> NDArray[np.uint8]:
    """Return the classes of a picture of the simulated camera that is given to a network in another way."""
    other = copy(eyes)
    other.pixels = pixels
    return other.perceive(rgb, CAMERA, CameraAttitude()).labels
