import shutil

import numpy as np
import pytest
from recorded_scenes import write_scene

from coral.contact.real_scenes.cameras.recorded_camera import RecordedRgbdCamera
from coral.errors import InputError


@pytest.fixture
def folder(trial, tmp_path):
    write_scene(tmp_path / "scene", trial, colours="shaded")
    return tmp_path / "scene"


def test_pictures_come_one_after_the_other_and_end(folder):
    camera = RecordedRgbdCamera(folder)
    camera.start()
    frames = [camera.newest(), camera.newest(), camera.newest()]
    assert [frame and round(frame.time_s, 3) for frame in frames] == [0.0, 0.1, None]


def test_a_calibrated_pose_replaces_the_recorded_one(folder):
    placed = np.diag([1.0, -1.0, -1.0, 1.0])
    assert RecordedRgbdCamera(folder, placed).newest().T_world_camera == pytest.approx(placed)


def test_a_folder_without_pictures_is_one_line(folder, tmp_path):
    with pytest.raises(InputError, match="--camera: found recording"):
        RecordedRgbdCamera(tmp_path / "nowhere")
    shutil.rmtree(folder / "depth")
    with pytest.raises(InputError, match="no picture"):
        RecordedRgbdCamera(folder)
