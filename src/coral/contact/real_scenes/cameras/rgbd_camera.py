"""The interface of a camera with colour and depth."""

from __future__ import annotations

from typing import Protocol

from coral.contact.perception.camera import RgbdFrame
from coral.errors import RunError


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
        ...

    def newest(self) -> RgbdFrame | None:
        """Return the newest picture that was not returned before; None if there is none. Never waits.

        Its `time_s` is the time at which it was taken, by the camera's clock. Nothing in it has a name, so it holds no
        mask. A recording has ended when it returns None.

        Raises:
            CameraFailed: The camera failed.
        """
        ...

    def close(self) -> None:
        """Release the camera; never fails, and may be called again."""
        ...
