"""The cameras by name: `--camera`, its help and its errors follow from this registry."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from coral.contact.real_scenes.cameras.bag_camera import BagRgbdCamera
from coral.contact.real_scenes.cameras.realsense_camera import HEIGHT, RATE_HZ, WIDTH, RealSenseCamera
from coral.contact.real_scenes.cameras.recorded_camera import RecordedRgbdCamera
from coral.contact.real_scenes.cameras.rgbd_camera import RgbdCamera
from coral.errors import InputError
from coral.plugins import find_plugins, named_plugin

Array = NDArray[np.float64]
GROUP = "coral.cameras"


@dataclass(frozen=True)
class CameraKind:
    """A camera on the command line."""

    form: str
    """Form of the value after `--camera`."""
    help: str
    """Description, as half a sentence."""
    make: Callable[[str, Array | None], RgbdCamera]
    """Makes it from what follows the first colon ("" without one) and T_world_camera."""


CAMERAS: dict[str, CameraKind] = {
    "recording": CameraKind(
        "recording:FOLDER",
        "recorded pictures in the format of BOP: depth, rgb, scene_camera.json",
        lambda rest, placed: RecordedRgbdCamera(Path(rest), placed),
    ),
    "bag": CameraKind(
        "bag:FILE",
        "a ROS 2 bag or MCAP file with colour, aligned depth and camera_info (extra bags)",
        BagRgbdCamera,
    ),
    "realsense": CameraKind(
        "realsense[:SERIAL]",
        f"a RealSense with {WIDTH} x {HEIGHT} pixels, {RATE_HZ} Hz, depth aligned to the colours (extra realsense)",
        lambda rest, placed: RealSenseCamera(rest or None, placed),
    ),
    "drawn": CameraKind(
        "drawn:TASK",
        "noisy drawn pictures of a task's scene as it begins, to practise with",
        lambda rest, placed: _still_camera(rest, placed),
    ),
}


def _still_camera(task: str, T_world_camera: Array | None) -> RgbdCamera:
    from coral.contact.real_scenes.cameras.drawn_camera import still_camera  # MuJoCo is slow to import

    return still_camera(task, T_world_camera)


def camera_help() -> str:
    """List the cameras with their descriptions, for the command line's help."""
    return "; or ".join(f"{kind.form}, {kind.help}" for kind in CAMERAS.values())


def make_camera_by_name(word: str, T_world_camera: Array | None = None) -> RgbdCamera:
    """Make the camera that a word names; it is not started yet.

    Args:
        word: NAME or NAME:REST.
        T_world_camera: Shape=(4, 4), where the camera stands; None if it is not known.

    Raises:
        InputError: There is no such camera.
    """
    name, _, rest = word.partition(":")
    if name not in CAMERAS and name in find_plugins(GROUP):
        made: RgbdCamera = named_plugin(GROUP, name, "--camera")(rest, T_world_camera)
        return made
    kind = CAMERAS.get(name) or named_plugin(GROUP, name, "--camera", ours=[kind.form for kind in CAMERAS.values()])
    if not rest and kind.form.endswith((":FOLDER", ":FILE", ":TASK")):
        raise InputError("--camera", "", repr(word), kind.form)
    return kind.make(rest, T_world_camera)
