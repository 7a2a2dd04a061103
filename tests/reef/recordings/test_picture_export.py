"""Colour pictures with poses, and nothing else."""

import numpy as np
import pytest
from given_eyes import FlatEyes
from survey_runs import write_run

from coral.errors import InputError
from coral.reef.recordings.find_recording import find_recording
from coral.reef.recordings.picture_export import export_pictures
from coral.reef.recordings.recorded_pictures import PicturePerception
from coral.reef.recordings.run_recording import read_run


def test_poses_camera_and_colours_come_back(tmp_path):
    write_run(tmp_path / "patch-001", colour=True)
    there = read_run(tmp_path / "patch-001").located()
    assert export_pictures(there, tmp_path / "out") == {"pictures": 41}
    assert {path.suffix for path in (tmp_path / "out").iterdir()} == {".csv", ".yaml", ".jpg"}
    back = find_recording(tmp_path / "out", perception=PicturePerception(FlatEyes(), "flat"))
    assert back.camera == there.camera
    for mine, theirs in zip(back.keyframes(), there.keyframes(), strict=True):
        assert mine.t == theirs.t
        assert mine.pose == pytest.approx(theirs.pose, abs=1e-7)
        assert np.abs(mine.frame.rgb.astype(int) - theirs.frame.rgb).mean() < 3  # a JPEG of a JPEG


def test_a_run_without_colours_has_nothing_to_write(survey_run, tmp_path):
    with pytest.raises(InputError, match=r"no colour picture at 0 s, expected a run with --cfg\.simulator\.pictures"):
        export_pictures(read_run(survey_run).located(), tmp_path / "out")
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "out").mkdir()
    with pytest.raises(InputError, match="something that exists already"):
        export_pictures(read_run(survey_run).located(), tmp_path / "out")
