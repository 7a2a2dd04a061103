"""The interface of a camera with colour and depth, and its pictures one after the other, with a limit on silence."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Protocol

from coral.contact.perception.camera import RgbdFrame
from coral.errors import RunError

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
