"""The pictures of a camera, one after the other, with a limit on its silence."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

from coral.contact.perception.camera import RgbdFrame
from coral.contact.real_scenes.cameras.rgbd_camera import CameraFailed, RgbdCamera

SILENCE_S = 5.0
"""A live camera without a picture for this long has failed; some need seconds for the first one."""
_POLL_S = 0.002


def stream_frames(
    camera: RgbdCamera, silence_s: float = SILENCE_S, sleep: Callable[[float], None] = time.sleep
) -> Iterator[RgbdFrame]:
    """Return the pictures of a camera that has started: those of a recording to its end, live ones as they come.

    Args:
        camera: The camera.
        silence_s: Longest wait for a live picture.
        sleep: Waits for a number of seconds; for tests.

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
