"""A run folder as a recording."""

import shutil
from dataclasses import replace

import numpy as np
import pytest
from survey_runs import write_run

from coral.errors import InputError
from coral.reef.eyes.doubt import DoubtCfg
from coral.reef.recordings.recording import map_of
from coral.reef.recordings.run_recording import read_run


def test_a_run_knows_its_camera_area_and_start(survey_run):
    recording = read_run(survey_run)
    assert (recording.name, recording.camera.width, recording.area) == ("patch", 80, (0.0, 0.0, 9.0, 8.0))
    assert recording.start == (2.0, 2.0, 0.5)


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


def test_a_run_of_a_network_keeps_its_doubt_and_gives_the_same_map(tmp_path):
    own = write_run(tmp_path / "doubtful", doubtful=True)
    recording = read_run(tmp_path / "doubtful").located()
    frame = next(iter(recording.keyframes())).frame
    np.testing.assert_allclose(frame.doubt, np.random.default_rng(0).random(frame.depth.shape), atol=0.5 / 255 + 1e-6)
    again = map_of(recording)
    trusting = map_of(replace(recording, map=replace(recording.map, doubt=DoubtCfg(oyster=1.0, seabed=1.0))))
    # Depth is kept in millimetres: a few pixels fall into the cell beside.
    assert np.count_nonzero(again.target != own.target) <= 0.02 * own.target.sum()
    assert np.count_nonzero(trusting.target != own.target) > 0.1 * own.target.sum()
