"""An Intel RealSense by librealsense (`pyrealsense2`): colour, and depth aligned to it."""

from __future__ import annotations

from typing import Any

import numpy as np

from coral.contact.perception.camera import RgbdFrame
from coral.contact.real_scenes.cameras.rgbd_camera import CameraFailed, bare_frame
from coral.contact.real_scenes.cameras.undistortion import Undistortion
from coral.contact.scene.observation import Array
from coral.errors import InputError, first_line, install_extra

WIDTH, HEIGHT, RATE_HZ = 640, 480, 30
"""What a D435 delivers for both streams by USB 2 too."""


class RealSenseCamera:
    """Streams from the first camera found, or from the one with a serial number; by default its frame is the world's.

    Raises:
        InputError: The extra `realsense` is missing.
    """

    live = True

    def __init__(self, serial: str = "", T_world_camera: Array | None = None) -> None:
        self.name = f"realsense:{serial}" if serial else "realsense"
        try:
            import pyrealsense2
        except ImportError as error:
            expected = install_extra("realsense")
            raise InputError("--camera", "", f"{self.name} ({first_line(error)})", expected) from None
        self._rs: Any = pyrealsense2
        self._serial, self._placed = serial, np.eye(4) if T_world_camera is None else T_world_camera
        self._pipeline: Any = None

    def start(self) -> None:
        """See `RgbdCamera.start`."""
        rs, config, pipeline = self._rs, self._rs.config(), self._rs.pipeline()
        if self._serial:
            config.enable_device(self._serial)
        config.enable_stream(rs.stream.depth, WIDTH, HEIGHT, rs.format.z16, RATE_HZ)
        config.enable_stream(rs.stream.color, WIDTH, HEIGHT, rs.format.rgb8, RATE_HZ)
        try:
            profile = pipeline.start(config)
        except RuntimeError as error:
            expected = f"a RealSense with colour and depth at {WIDTH} x {HEIGHT}, {RATE_HZ} Hz"
            raise InputError("--camera", "", f"{self.name} ({first_line(error)})", expected) from None
        self._pipeline = pipeline
        self._depth_m = float(profile.get_device().first_depth_sensor().get_depth_scale())
        found = profile.get_stream(rs.stream.color).as_video_stream_profile().get_intrinsics()
        lens = np.array([found.fx, found.fy, found.ppx, found.ppy])
        inverse = found.model == rs.distortion.inverse_brown_conrady
        size = (int(found.height), int(found.width))
        self._removal = Undistortion(lens, np.asarray(found.coeffs, float), size, inverse=inverse)
        self._align = rs.align(rs.stream.color)

    def newest(self) -> RgbdFrame | None:
        """See `RgbdCamera.newest`."""
        if self._pipeline is None:
            return None
        frames = None
        try:
            while waiting := self._pipeline.poll_for_frames():
                frames = waiting  # only the newest counts
            if frames is None:
                return None
            aligned = self._align.process(frames)
            depth, colour = aligned.get_depth_frame(), aligned.get_color_frame()
        except RuntimeError as error:
            raise CameraFailed(f"the camera {self.name} failed: {first_line(error)}") from None
        if not depth or not colour:
            return None
        metres = np.asarray(depth.get_data(), np.uint16) * np.float32(self._depth_m)
        rgb = np.array(colour.get_data(), np.uint8)
        time_s = 1e-3 * float(colour.get_timestamp())
        removal = self._removal
        return bare_frame(removal.apply(metres), removal.apply(rgb), removal.lens, self._placed, time_s)

    def close(self) -> None:
        """See `RgbdCamera.close`."""
        pipeline, self._pipeline = self._pipeline, None
        if pipeline is not None:
            try:
                pipeline.stop()
            except RuntimeError:  # it was unplugged
                return
