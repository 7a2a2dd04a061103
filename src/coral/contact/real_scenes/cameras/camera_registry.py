"""The cameras by name: `--camera`, its help and its errors follow from this registry."""

from __future__ import annotations

from coral.contact.real_scenes.cameras.bag_camera import BagRgbdCamera
from coral.contact.real_scenes.cameras.realsense_camera import HEIGHT, RATE_HZ, WIDTH, RealSenseCamera
from coral.contact.real_scenes.cameras.rgbd_camera import RgbdCamera
from coral.contact.scene.observation import Array
from coral.errors import InputError
from coral.plugins import named_plugin

GROUP = "coral.cameras"


CAMERAS = {
    "bag:FILE": "a ROS 2 bag or MCAP file with colour, aligned depth and camera_info (extra bags)",
    "realsense[:SERIAL]": f"a RealSense with {WIDTH} x {HEIGHT} pixels, {RATE_HZ} Hz, depth aligned to the colours "
    "(extra realsense)",
    "drawn:TASK": "noisy drawn pictures of a task's scene as it begins, to practise with",
}
"""Description of each form of the value after `--camera`, as half a sentence."""


def camera_help() -> str:
    """List the cameras with their descriptions, for the command line's help."""
    return "; or ".join(f"{form}, {what}" for form, what in CAMERAS.items())


def make_camera_by_name(word: str, T_world_camera: Array | None = None) -> RgbdCamera:
    """Make the camera that NAME or NAME:REST names; it is not started yet. T_world_camera is None if it is not known.

    Raises:
        InputError: There is no such camera.
    """
    name, _, rest = word.partition(":")
    form = next((form for form in CAMERAS if form.partition(":")[0] == name), None)
    if form is not None and not rest:
        raise InputError("--camera", "", repr(word), form)
    if name == "realsense":
        return RealSenseCamera(rest or None, T_world_camera)
    if name == "bag":
        return BagRgbdCamera(rest, T_world_camera)
    if name == "drawn":
        from coral.contact.real_scenes.cameras.drawn_camera import still_camera  # MuJoCo is slow to import

        return still_camera(rest, T_world_camera)
    made: RgbdCamera = named_plugin(GROUP, name, "--camera", ours=[*CAMERAS])(rest, T_world_camera)
    return made
