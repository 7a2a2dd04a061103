import threading

import cv2
import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.sea import video_camera
from coral.reef.sea.video_camera import VideoCamera, resized
from coral.reef.vehicle.camera import CameraCfg


@pytest.fixture
def video(tmp_path):
    path = tmp_path / "reef.avi"
    out = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"MJPG"), 1000.0, (64, 48))
    for k in range(5):
        out.write(np.full((48, 64, 3), (0, 0, 40 * k), np.uint8))  # red in BGR
    out.release()
    return path


def test_a_file_gives_its_pictures_in_rgb_and_then_complains(video):
    camera = VideoCamera(str(video), latency_s=0.25, clock=lambda: 10.0)
    shots = [camera.read() for _ in range(4)]  # the first was read to find out the size
    assert shots[0].stamp_s == 9.75
    assert shots[3].rgb.shape == (48, 64, 3)
    red, green, blue = shots[3].rgb.reshape(-1, 3).mean(axis=0)
    assert red > 120
    assert max(green, blue) < 40
    with pytest.raises(OSError, match="no more pictures"):
        camera.read()
    assert camera.name.endswith("64x48")
    camera.close()


def test_what_is_no_video_is_refused(tmp_path):
    (tmp_path / "text.avi").write_text("no video")
    with pytest.raises(InputError, match="a video that OpenCV can read"):
        VideoCamera(str(tmp_path / "text.avi"))


def test_the_password_of_a_camera_is_in_no_message(monkeypatch, video):
    open_file, address = cv2.VideoCapture, "rtsp://admin:s3cret@10.0.0.1/v"
    monkeypatch.setattr(cv2, "VideoCapture", lambda *_: open_file(str(video)))
    camera = VideoCamera(address, clock=lambda: 10.0)
    assert camera.name == "rtsp://***@10.0.0.1/v, 64x48"
    for _ in range(4):
        camera.read()
    with pytest.raises(OSError, match=r"^rtsp://\*\*\*@10\.0\.0\.1/v gives no more pictures"):
        camera.read()
    monkeypatch.setattr(cv2, "VideoCapture", lambda *_: open_file("nothing"))
    with pytest.raises(InputError) as refused:
        VideoCamera(address)
    assert "s3cret" not in str(refused.value)
    assert "***@10.0.0.1" in str(refused.value)


def test_a_stream_that_another_thread_waits_in_is_not_freed(monkeypatch, video):
    monkeypatch.setattr(video_camera, "READ_S", 0.05)
    camera, waiting, done, freed = VideoCamera(str(video)), threading.Event(), threading.Event(), []

    class Stalled:
        def read(self):
            waiting.set()
            done.wait(10.0)
            return True, np.zeros((48, 64, 3), np.uint8)

        def release(self):
            freed.append(1)

    camera._video.release()
    camera._video = Stalled()
    reader = threading.Thread(target=camera.read)
    reader.start()
    waiting.wait(10.0)
    camera.close()
    assert not freed
    done.set()
    reader.join(10.0)
    camera.close()
    assert freed


def test_without_a_lens_only_the_size_may_differ():
    camera = CameraCfg()
    assert resized(np.zeros((480, 640, 3), np.uint8), camera).shape == (120, 160, 3)
    with pytest.raises(ValueError, match="give its size and lens by --lens"):
        resized(np.zeros((720, 1280, 3), np.uint8), camera)
