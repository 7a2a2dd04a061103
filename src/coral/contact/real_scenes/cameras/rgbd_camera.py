"""Cameras with colour and depth: the interface, the cameras by name, and pictures one after the other."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame
from coral.contact.scene.observation import Array
from coral.errors import RunError
from coral.plugins import named_plugin

CAMERAS = {
    "bag:FILE": "a ROS 2 bag or MCAP file with colour, aligned depth and camera_info (extra bags)",
    "realsense[:SERIAL]": "a RealSense with 640 x 480 pixels, 30 Hz, depth aligned to the colours (extra realsense)",
    "drawn:TASK": "noisy drawn pictures of a task's scene as it begins, to practise with",
}
"""Description of each form of the value after `--camera`, as half a sentence."""

SILENCE_S = 5.0
"""A live camera without a picture for this long has failed; some need seconds for the first one."""
_POLL_S = 0.002


class CameraFailed(RunError):
    """A camera failed while it delivered pictures, for example because it was unplugged."""


class RgbdCamera(Protocol):
    """Delivers pictures with colours and depth aligned to them.

    Attributes:
        name: Name for records.
        live: Whether pictures arrive by the clock. A recording gives its next picture at each call instead.
    """

    name: str
    live: bool

    def start(self) -> None:
        """Begin to deliver pictures.

        Raises:
            InputError: There is no such camera, or what it delivers cannot be used.
        """

    def newest(self) -> RgbdFrame | None:
        """Return the newest picture that was not returned before; None if there is none. Never waits.

        Its `time_s` is the time at which it was taken, by the camera's clock. Nothing in it has a name, so it holds no
        mask. A recording has ended when it returns None.

        Raises:
            CameraFailed: The camera failed.
        """

    def close(self) -> None:
        """Release the camera; never fails, and may be called again."""


def make_camera_by_name(word: str, T_world_camera: Array | None = None) -> RgbdCamera:
    """Make the camera that NAME or NAME:REST names; it is not started yet. T_world_camera is None if it is not known.

    Raises:
        InputError: There is no such camera.
    """
    name, _, rest = word.partition(":")
    made: RgbdCamera = named_plugin("coral.cameras", name, "--camera")(rest, T_world_camera)
    return made


def bare_frame(
    depth: NDArray[np.float32], rgb: NDArray[np.uint8] | None, lens: Array, placed: Array, time_s: float
) -> RgbdFrame:
    """Make a picture in which nothing has a name, of depth in metres, 0 or not finite where nothing was measured."""
    measured = np.where(np.isfinite(depth) & (depth > 0), depth, 0.0).astype(np.float32)
    return RgbdFrame(measured, np.zeros(measured.shape, np.uint8), (), lens, placed, time_s, rgb)


def stream_frames(
    camera: RgbdCamera, silence_s: float = SILENCE_S, sleep: Callable[[float], None] = time.sleep
) -> Iterator[RgbdFrame]:
    """Return the pictures of a camera that has started: those of a recording to its end, live ones as they come.

    Raises:
        CameraFailed: A live camera is silent.
    """
    waited = 0.0
    while True:
        frame = camera.newest()
        if frame is not None:
            waited = 0.0
            yield frame
        elif not camera.live:
            return
        else:
            if waited >= silence_s:
                raise CameraFailed(f"the camera {camera.name} sent no picture for {silence_s:g} s")
            sleep(_POLL_S)
            waited += _POLL_S
