"""A stand-in module with pyrealsense2's interface; no camera was at hand."""

import sys
from types import SimpleNamespace

import numpy as np
import pytest

from coral.contact.real_scenes.cameras.realsense_camera import RealSenseCamera
from coral.contact.real_scenes.cameras.rgbd_camera import CameraFailed
from coral.errors import InputError


class Frame(SimpleNamespace):
    def get_data(self):
        return self.data

    def get_timestamp(self):
        return self.ms


class StandIn:
    """Two sets of frames are waiting at the first poll."""

    stream = SimpleNamespace(depth="depth", color="color")
    format = SimpleNamespace(z16="z16", rgb8="rgb8")
    distortion = SimpleNamespace(inverse_brown_conrady="inverse")

    def __init__(self, fails=""):
        self.fails, self.serials, self.waiting, self.stopped = fails, [], [1000.0, 1033.0], 0

    def config(self):
        return SimpleNamespace(enable_device=self.serials.append, enable_stream=lambda *words: None)

    def pipeline(self):
        return SimpleNamespace(start=self.start, stop=self.stop, poll_for_frames=self.poll)

    def start(self, config):
        if self.fails == "start":
            raise RuntimeError("No device connected")
        lens = SimpleNamespace(
            fx=600.0, fy=601.0, ppx=320.0, ppy=240.0, model="inverse", coeffs=[0.0] * 5, width=640, height=480
        )
        video = SimpleNamespace(get_intrinsics=lambda: lens)
        sensor = SimpleNamespace(get_depth_scale=lambda: 0.001)
        return SimpleNamespace(
            get_device=lambda: SimpleNamespace(first_depth_sensor=lambda: sensor),
            get_stream=lambda which: SimpleNamespace(as_video_stream_profile=lambda: video),
        )

    def stop(self):
        self.stopped += 1

    def poll(self):
        if self.fails == "poll":
            raise RuntimeError("Frame didn't arrive: the device was unplugged")
        return self.waiting.pop(0) if self.waiting else None

    def align(self, to):
        assert to == "color"

        def process(ms):
            depth = Frame(data=np.full((480, 640), 750, np.uint16), ms=ms)
            colour = Frame(data=np.full((480, 640, 3), 7, np.uint8), ms=ms)
            return SimpleNamespace(get_depth_frame=lambda: depth, get_color_frame=lambda: colour)

        return SimpleNamespace(process=process)


def started(monkeypatch, stand_in, serial=None):
    monkeypatch.setitem(sys.modules, "pyrealsense2", stand_in)
    camera = RealSenseCamera(serial)
    camera.start()
    return camera


def test_the_newest_picture_counts(monkeypatch):
    camera = started(monkeypatch, StandIn())
    frame = camera.newest()
    assert frame.time_s == pytest.approx(1.033)
    assert frame.depth[0, 0] == pytest.approx(0.75)
    assert frame.rgb[0, 0].tolist() == [7, 7, 7]
    assert camera.newest() is None


def test_a_serial_number_chooses_the_camera(monkeypatch):
    stand_in = StandIn()
    started(monkeypatch, stand_in, "0123")
    assert stand_in.serials == ["0123"]


def test_a_missing_package_is_one_line(monkeypatch):
    monkeypatch.setitem(sys.modules, "pyrealsense2", None)
    with pytest.raises(InputError, match=r"--camera: found realsense .*, expected the extra realsense"):
        RealSenseCamera()


def test_a_missing_camera_is_one_line(monkeypatch):
    with pytest.raises(InputError, match=r"--camera: found realsense \(No device connected\), expected a RealSense"):
        started(monkeypatch, StandIn("start"))


def test_a_camera_that_is_unplugged_fails(monkeypatch):
    stand_in = StandIn("poll")
    camera = started(monkeypatch, stand_in)
    with pytest.raises(CameraFailed, match="unplugged"):
        camera.newest()
    camera.close()
    camera.close()
    assert stand_in.stopped == 1
