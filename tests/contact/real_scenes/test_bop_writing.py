import numpy as np
import pytest
from recorded_scenes import write_scene

from coral.contact.real_scenes.cameras.recorded_camera import RecordedRgbdCamera
from coral.errors import InputError


def test_what_was_written_is_read_again(trial, tmp_path):
    frames = write_scene(tmp_path / "scene", trial)
    camera = RecordedRgbdCamera(tmp_path / "scene")
    for frame in frames:
        read = camera.newest()
        assert np.abs(read.depth - frame.depth).max() <= 0.00005 + 1e-6
        assert np.allclose(read.lens, frame.lens)
        assert np.allclose(read.T_world_camera, frame.T_world_camera)


def test_nothing_of_the_user_s_is_overwritten(trial, tmp_path):
    (tmp_path / "scene").mkdir()
    (tmp_path / "scene" / "mine.txt").write_text("mine")
    with pytest.raises(InputError, match="new or empty"):
        write_scene(tmp_path / "scene", trial)
