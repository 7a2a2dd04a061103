"""The cameras by name: what `--camera` takes."""

from __future__ import annotations

from coral.contact.real_scenes.cameras.realsense_camera import HEIGHT, RATE_HZ, WIDTH
from coral.contact.real_scenes.cameras.rgbd_camera import RgbdCamera
from coral.contact.scene.observation import Array
from coral.plugins import named_plugin

CAMERAS = {
    "bag:FILE": "a ROS 2 bag or MCAP file with colour, aligned depth and camera_info (extra bags)",
    "realsense[:SERIAL]": f"a RealSense with {WIDTH} x {HEIGHT} pixels, {RATE_HZ} Hz, depth aligned to the colours "
    "(extra realsense)",
    "drawn:TASK": "noisy drawn pictures of a task's scene as it begins, to practise with",
}
"""Description of each form of the value after `--camera`, as half a sentence."""


def make_camera_by_name(word: str, T_world_camera: Array | None = None) -> RgbdCamera:
    """Make the camera that NAME or NAME:REST names; it is not started yet. T_world_camera is None if it is not known.

    Raises:
        InputError: There is no such camera.
    """
    name, _, rest = word.partition(":")
    made: RgbdCamera = named_plugin("coral.cameras", name, "--camera")(rest, T_world_camera)
    return made
