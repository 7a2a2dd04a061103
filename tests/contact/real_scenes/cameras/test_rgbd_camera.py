import numpy as np
import pytest

from coral.contact.real_scenes.cameras import rgbd_camera
from coral.contact.real_scenes.cameras.rgbd_camera import CameraFailed, bare_frame, make_camera_by_name, stream_frames
from coral.errors import InputError


class Camera:
    name = "stand-in"

    def __init__(self, frames, live):
        self.frames, self.live = list(frames), live

    def newest(self):
        return self.frames.pop(0) if self.frames else None


def test_a_recording_ends_with_its_last_picture():
    assert list(stream_frames(Camera(["a", "b"], live=False))) == ["a", "b"]


def test_a_live_camera_is_waited_for():
    frames = stream_frames(Camera([None, None, "a"], live=True), sleep=lambda seconds: None)
    assert next(frames) == "a"


def test_a_silent_camera_has_failed():
    slept = []
    with pytest.raises(CameraFailed, match=r"no picture for 0\.1 s"):
        next(stream_frames(Camera([], live=True), silence_s=0.1, sleep=slept.append))
    assert sum(slept) == pytest.approx(0.1)


def test_a_word_makes_a_camera():
    assert make_camera_by_name("drawn:flip-box").newest() is not None


@pytest.mark.parametrize("word", ["bag", "bag:", "drawn", "kinect", ""])
def test_a_word_that_names_none_is_one_line(word):
    with pytest.raises(InputError, match=r"^--camera: found"):
        make_camera_by_name(word)


def test_another_package_offers_a_camera(monkeypatch):
    monkeypatch.setattr(rgbd_camera, "named_plugin", lambda *words: lambda rest, placed: (rest, placed))
    rest, placed = make_camera_by_name("mine:192.168.1.5", np.eye(4))
    assert rest == "192.168.1.5"
    assert placed is not None


def test_what_was_not_measured_is_zero():
    depth = np.array([[1.0, np.nan, np.inf, -1.0]], np.float32)
    assert bare_frame(depth, None, np.ones(4), np.eye(4), 0.0).depth.tolist() == [[1.0, 0.0, 0.0, 0.0]]
