import shutil

import numpy as np
import pytest
from recorded_scenes import write_scene

from coral.contact.real_scenes.cameras.recorded_camera import RecordedRgbdCamera
from coral.errors import InputError


@pytest.fixture
def folder(trial, tmp_path):
    write_scene(tmp_path / "scene", trial)
    return tmp_path / "scene"


def test_pictures_are_read_as_they_were_written(trial, tmp_path):
    frames = write_scene(tmp_path / "scene", trial)
    camera = RecordedRgbdCamera(tmp_path / "scene")
    for frame in frames:
        read = camera.newest()
        assert np.abs(read.depth - frame.depth).max() <= 0.00005 + 1e-6
        assert np.allclose(read.lens, frame.lens)
        assert np.allclose(read.T_world_camera, frame.T_world_camera)
        assert np.array_equal(read.rgb, frame.rgb)


def test_pictures_come_one_after_the_other_and_end(folder):
    camera = RecordedRgbdCamera(folder)
    camera.start()
    frames = [camera.newest(), camera.newest(), camera.newest()]
    assert [frame and round(frame.time_s, 3) for frame in frames] == [0.0, 0.1, None]
    assert frames[1].names == ()
    assert not frames[1].instance.any()


def test_a_calibrated_pose_replaces_the_recorded_one(folder):
    placed = np.diag([1.0, -1.0, -1.0, 1.0])
    assert RecordedRgbdCamera(folder, placed).newest().T_world_camera == pytest.approx(placed)


def test_a_folder_without_pictures_is_one_line(folder, tmp_path):
    with pytest.raises(InputError, match="--camera: found recording"):
        RecordedRgbdCamera(tmp_path / "nowhere")
    shutil.rmtree(folder / "depth")
    with pytest.raises(InputError, match="no picture"):
        RecordedRgbdCamera(folder)


def test_colours_of_another_size_than_depth_are_refused(folder):
    shutil.copy(folder / "depth/000000.png", folder / "rgb/000000.png")
    with pytest.raises(InputError, match="rgb: 000000: found an array"):
        RecordedRgbdCamera(folder).newest()


def test_one_camera_for_all_stands_above_the_folder(folder):
    (folder / "scene_camera.json").unlink()
    (folder.parent / "camera.json").write_text('{"fx": 5, "fy": 6, "cx": 7, "cy": 8, "depth_scale": 1.0, "width": 640}')
    frame = RecordedRgbdCamera(folder).newest()
    assert frame.lens == pytest.approx([5, 6, 7, 8])
    assert np.array_equal(frame.T_world_camera, np.eye(4))
