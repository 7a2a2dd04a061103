"""Eyes by name: exact, painted, rgb, or a file."""

from __future__ import annotations

from pathlib import Path

from coral.errors import InputError, nearest
from coral.onnx_file import open_picture_network
from coral.plugins import has_plugin, named_plugin, our_part
from coral.reef.eyes.painted_only import PaintedOnlyEyes
from coral.reef.eyes.perception import RgbPerception
from coral.reef.eyes.reef_net import REAL, SHIPPED, ReefNetEyes

EXACT, PAINTED, RGB = "exact", "painted", "rgb"
_NETWORKS = {PAINTED: SHIPPED, RGB: REAL}


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
