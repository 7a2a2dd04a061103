import numpy as np
import pytest

from coral.reef.sea.live_view import LiveView, resized
from coral.reef.vehicle.camera import CameraCfg


def test_a_picture_is_rectified_and_reduced(tmp_path):
    path = tmp_path / "camera.yaml"
    path.write_text("width: 1280\nheight: 720\nfx: 900\nfy: 900\ndistortion: [-0.2, 0.05, 0, 0]\npitch_down_deg: 20\n")
    view = LiveView.of_file(path)
    assert (view.camera.width, view.camera.pitch_down_deg) == (320, 20.0)
    assert 60.0 < view.camera.hfov_deg < 90.0
    picture = view.picture(np.full((720, 1280, 3), 80, np.uint8))
    assert picture.shape == (view.camera.height, 320, 3)
    assert (picture == 80).mean() > 0.95
    with pytest.raises(ValueError, match="640x480 px, where the camera file says 1280x720"):
        view.picture(np.zeros((480, 640, 3), np.uint8))


def test_without_a_lens_only_the_size_may_differ():
    camera = CameraCfg()
    assert resized(np.zeros((480, 640, 3), np.uint8), camera).shape == (120, 160, 3)
    with pytest.raises(ValueError, match="give its size and lens by --lens"):
        resized(np.zeros((720, 1280, 3), np.uint8), camera)
