"""A real camera, read by OpenCV: a video file, an RTSP or HTTP address, a V4L2 device, a GStreamer pipeline."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError, without_password
from coral.reef.sea.latest_reading import Shot
from coral.reef.vehicle.camera import CameraCfg

OPEN_MS = 5000
"""Longest time to open an address (ms)."""
READ_S = 2.0
"""A stream that is read longer than this when it is closed is left to the end of the process."""
WIDEST_PX = 320
"""Wider pictures are reduced to this: eyes and map keep a camera's rate with it. Twice what the networks here see."""
ALIKE = 0.02
"""Relative difference of two pictures' proportions that makes no difference."""

Fit = Callable[[NDArray[np.uint8]], NDArray[np.uint8]]


def resized(rgb: NDArray[np.uint8], camera: CameraCfg) -> NDArray[np.uint8]:
    """Return a picture in the size of a camera with the same view. Shape=(H, W, 3).

    Raises:
        ValueError: It has other proportions: then it is not of this camera.
    """
    height, width = rgb.shape[:2]
    if abs(width * camera.height / (height * camera.width) - 1.0) > ALIKE:
        raise ValueError(
            f"pictures of {width}x{height} px, where the camera is configured with {camera.width}x{camera.height}: "
            "give its size and lens by --lens camera.yaml"
        )
    if (width, height) == (camera.width, camera.height):
        return rgb
    return np.asarray(cv2.resize(rgb, (camera.width, camera.height), interpolation=cv2.INTER_AREA), np.uint8)


class VideoCamera:
    """Reads pictures of a stream. They have no depth and no classes: eyes have to find them."""

    def __init__(
        self,
        address: str,
        latency_s: float = 0.0,
        fit: Fit = lambda rgb: rgb,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Open a file, URL, device (`/dev/video0` or `0`), or a GStreamer pipeline where OpenCV has GStreamer.

        `latency_s` is the time from the light to the picture's arrival here, as calibrated. `fit` makes a picture one
        of the camera that the robot reckons with, or raises ValueError.

        Raises:
            InputError: It cannot be opened, gives no picture, or one of another camera.
        """
        self._address, self._latency_s = without_password(address), latency_s
        self._fit, self._clock = fit, clock
        self._reading = threading.Lock()
        digits = address.removeprefix("/dev/video")
        where: str | int = int(digits) if digits.isdigit() else address
        if "://" in address:
            self._video = cv2.VideoCapture(where, cv2.CAP_ANY, [cv2.CAP_PROP_OPEN_TIMEOUT_MSEC, OPEN_MS])
        else:
            self._video = cv2.VideoCapture(where)
        self._video.set(cv2.CAP_PROP_BUFFERSIZE, 1)  # an old picture is worse than none
        good, first = self._video.read() if self._video.isOpened() else (False, None)
        if not good or first is None:
            self._video.release()
            raise InputError("--camera", "", repr(address), "simulated, or a video that OpenCV can read")
        height, width = first.shape[:2]
        try:
            fit(np.asarray(first, np.uint8))
        except ValueError as error:
            self._video.release()
            raise InputError("--camera", "", f"{address}: {error}", "pictures of the camera as configured") from None
        is_file = self._video.get(cv2.CAP_PROP_FRAME_COUNT) > 1
        self._file_period_s = 1.0 / max(self._video.get(cv2.CAP_PROP_FPS), 1.0) if is_file else 0.0
        self._due_s = clock()
        self.name = f"{self._address}, {width}x{height}"

    def read(self) -> Shot | None:
        """Wait for the next picture; a file plays at its own speed. None at its end or when the stream breaks."""
        if self._file_period_s:
            self._due_s = max(self._due_s + self._file_period_s, self._clock() - 1.0)
            time.sleep(max(0.0, self._due_s - self._clock()))
        with self._reading:
            good, bgr = self._video.read()
        if not good or bgr is None:
            raise OSError(f"{self._address} gives no more pictures")
        rgb = np.ascontiguousarray(bgr[:, :, ::-1], dtype=np.uint8)
        return Shot(stamp_s=self._clock() - self._latency_s, rgb=self._fit(rgb))

    def close(self) -> None:
        """Free the stream, unless another thread waits in it for a picture: OpenCV then frees memory twice."""
        if self._reading.acquire(timeout=READ_S):
            self._video.release()
