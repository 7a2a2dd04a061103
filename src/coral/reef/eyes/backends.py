"""Eyes by name: exact, rgb, or a file."""

from __future__ import annotations

from pathlib import Path

from coral.errors import InputError, nearest
from coral.onnx_file import open_picture_network
from coral.reef.eyes.perception import RgbPerception
from coral.reef.eyes.reef_net import OUTPUTS, SHIPPED, ReefNetEyes
from coral.reef.eyes.relative_depth import DepthAnything
from coral.reef.eyes.relative_depth_eyes import RelativeDepthEyes
from coral.reef.eyes.semantic_map import SemanticEyes
from coral.reef.eyes.yolo_eyes import YoloEyes, is_yolo

EXACT, RGB = "exact", "rgb"


def open_eyes(name: str, where: str = "--perception", *, depth: str = "") -> RgbPerception | None:
    """Return eyes by name.

    Args:
        name: exact, rgb, or the path of an ONNX file, whose layout says what it is.
        where: Flag or key that it comes from, for errors.
        depth: ONNX file of a relative depth network, which replaces the depth of the eyes; "" for none.

    Returns:
        None for exact: the simulator's frames are used as they are.

    Raises:
        InputError: There is no such thing, or the file has a layout that is not known.
    """
    if depth:
        eyes = open_eyes(name, where)
        if eyes is None:
            raise InputError(
                "--depth", "", f"{depth} beside {EXACT}", f"--perception {RGB} or FILE.onnx, for the classes"
            )
        return RelativeDepthEyes(eyes, DepthAnything(open_picture_network(Path(depth), "--depth")))
    if name == EXACT:
        return None
    if name != RGB and not name.endswith(".onnx"):
        raise InputError(where, "", repr(name), f"exact, rgb or FILE.onnx{nearest(name, (EXACT, RGB))}")
    file = open_picture_network(SHIPPED if name == RGB else Path(name), where)
    if file.input_shape[1] == 4 and "depth_doubt" in file.outputs:
        return ReefNetEyes(file)
    if file.input_shape[1] != 3:
        raise InputError(
            file.path,
            "inputs",
            f"{file.input_shape[1]} channels",
            f"3 (red, green, blue), or 4 with outputs {', '.join(OUTPUTS)}",
        )
    if "predicted_depth" in file.outputs:
        raise InputError(file.path, "outputs", "predicted_depth alone", "classes; for depth give this file to --depth")
    if is_yolo(file):
        return YoloEyes(file)
    return SemanticEyes(file)
