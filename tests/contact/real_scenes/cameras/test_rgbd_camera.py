import pytest

from coral.contact.real_scenes.cameras.rgbd_camera import CameraFailed, stream_frames


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
