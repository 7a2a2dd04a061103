"""A run folder as a recording."""

import shutil

import pytest

from coral.errors import InputError
from coral.reef.recordings.run_recording import read_run


def test_a_run_knows_its_camera_area_and_start(survey_run):
    recording = read_run(survey_run)
    assert (recording.name, recording.camera.width, recording.area) == ("patch", 80, (0.0, 0.0, 9.0, 8.0))
    assert recording.start == (2.0, 2.0, 0.5)
    assert recording.final_map.shape == (160, 180)


def test_a_run_without_keyframes_and_what_is_no_run_are_refused(survey_run, tmp_path):
    with pytest.raises(InputError, match="the folder of a run"):
        read_run(tmp_path)
    copy = tmp_path / "run"
    shutil.copytree(survey_run, copy)
    (copy / "frames/poses.csv").unlink()
    with pytest.raises(InputError, match="a run that kept its keyframes"):
        read_run(copy)


def test_a_world_that_lacks_its_start_is_told(survey_run, tmp_path):
    copy = tmp_path / "run"
    shutil.copytree(survey_run, copy)
    (copy / "world.yaml").write_text("name: x\n")
    with pytest.raises(InputError, match="size_m, start"):
        read_run(copy)
