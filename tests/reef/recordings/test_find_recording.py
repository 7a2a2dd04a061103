"""Which kind of recording a path is."""

import pytest

from coral.errors import InputError
from coral.reef.recordings.find_recording import find_recording


def test_a_run_and_its_pictures_are_found(survey_run, tmp_path):
    assert find_recording(survey_run).name == "patch"
    (tmp_path / "cam.yaml").write_text("{width: 80, height: 60}\n")
    found = find_recording(survey_run / "frames", camera=tmp_path / "cam.yaml")
    assert (found.name, found.camera.width) == ("frames", 80)


def test_pictures_without_a_camera_and_other_things_are_refused(survey_run, tmp_path):
    with pytest.raises(InputError, match=r"camera\.yaml"):
        find_recording(survey_run / "frames")
    with pytest.raises(InputError, match="found something else, expected a run folder"):
        find_recording(tmp_path)
    with pytest.raises(InputError, match="found nothing"):
        find_recording(tmp_path / "gone")
