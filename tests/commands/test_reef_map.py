"""`coral reef map`: recordings of every kind become the same map."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "reef"))

from survey_runs import write_run

pytest.importorskip("tifffile")
pytest.importorskip("rosbags")


@pytest.fixture(scope="module")
def survey_run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("survey") / "patch-001"
    write_run(folder, drift=0.02)
    return folder


def test_a_run_its_mcap_file_and_its_bag_give_the_same_oysters(survey_run, tmp_path, told):
    assert told("export", survey_run, "--to", "mcap", "--out", tmp_path / "x.mcap")[0] == 0
    assert told("export", survey_run, "--to", "bag", "--out", tmp_path / "x_bag")[0] == 0
    made = []
    for k, recording in enumerate((survey_run, tmp_path / "x.mcap", tmp_path / "x_bag")):
        code, result, error = told("reef", "map", recording, "--out", tmp_path / str(k), "--json")
        assert code == 0, error
        made.append((result["oyster_cells"], result["oyster_area_m2"], (tmp_path / str(k) / "cells.png").read_bytes()))
    assert made[0] == made[1] == made[2]
    assert made[0][0] > 200


def test_pictures_with_poses_and_a_camera_file(survey_run, tmp_path, told):
    (tmp_path / "camera.yaml").write_text("{width: 80, height: 60}\n")
    code, out, _ = told(
        "reef", "map", survey_run / "frames", "--camera", tmp_path / "camera.yaml", "--out", tmp_path / "m", "--json"
    )
    assert code == 0
    assert out["clusters"] == 1
    assert "true_area_m2" not in out


def test_what_is_no_recording_is_one_line(tmp_path, told):
    (tmp_path / "text.mcap").write_text("no")
    for path in (tmp_path / "text.mcap", tmp_path, tmp_path / "gone"):
        code, _, error = told("reef", "map", path, "--out", tmp_path / "o")
        assert (code, error.count("\n")) == (2, 1)
