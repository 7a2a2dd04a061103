"""The stream to an arm together with the camera that gives it the objects' poses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from coral.contact.franka.camera_process import CameraProcess
from coral.contact.franka.stream import StopCause
from coral.contact.franka.stream_record import StreamReport
from coral.contact.franka.world import StreamHandle
from coral.contact.real_scenes.hand_mask import HandReading
from coral.contact.scene.observation import HandTarget
from coral.contact.scene.rigid_transform import body_to_matrix


class CameraStream:
    """A stream whose poses come from a camera; see `StreamHandle`. It ends the camera with itself.

    Args:
        stream: The stream.
        camera: The camera.
        base_m: Where the arm stands in the world.
    """

    def __init__(self, stream: StreamHandle, camera: CameraProcess, base_m: tuple[float, float, float]) -> None:
        self._stream, self._camera, self._base = stream, camera, np.asarray(base_m)

    def start(self) -> None:
        """See `StreamHandle.start`."""
        self._stream.start()

    def follow(self, target: HandTarget) -> None:
        """See `StreamHandle.follow`. The camera process learns where the hand is, and how far its fingers close."""
        self._stream.follow(target)
        now = self._stream.report()
        tool = replace(now.tool, position=now.tool.position + self._base)
        self._camera.tell_hand(HandReading(body_to_matrix(tool), now.opening_m, target.opening_m))

    def stop(self, cause: StopCause) -> None:
        """See `StreamHandle.stop`."""
        self._stream.stop(cause)

    def report(self) -> StreamReport:
        """See `StreamHandle.report`."""
        return self._stream.report()

    def reason(self) -> str:
        """Return why the arm was stopped; if the camera had failed, that too."""
        reason, failure = self._stream.reason(), self._camera.failure()
        return f"{reason}: {failure}" if failure else reason

    def close(self) -> None:
        """See `StreamHandle.close`."""
        self._stream.close()
        self._camera.close()
