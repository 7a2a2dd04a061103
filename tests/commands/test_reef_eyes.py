"""`coral reef eyes`: refused in time, and what its table says."""

import json

import pytest

from coral.cli import main


def test_a_score_is_one_json_object_with_a_row_for_each_water_and_light(capsys):
    pytest.importorskip("onnxruntime")
    words = ["reef", "eyes", "score", "--worlds", "s1", "--waters", "clear", "--pictures", "1", "--json"]
    assert main([*words, "--lights", "day", "overcast"]) == 0
    result = json.loads(capsys.readouterr().out)
    row, overcast = result["rows"]
    assert (row["water"], row["light"], row["pictures"]) == ("jerlov-IB", "day", 1)
    assert (overcast["water"], overcast["light"]) == ("jerlov-IB", "overcast")
    assert len(row["oyster_iou"]) == len(result["bands_m"]) - 1


def test_a_light_that_does_not_exist_is_refused(capsys):
    pytest.importorskip("onnxruntime")
    assert main(["reef", "eyes", "score", "--worlds", "s1", "--lights", "moon"]) == 2
    assert "--lights: found 'moon', expected one of day, low-sun" in capsys.readouterr().err


def test_training_refuses_a_file_that_exists(tmp_path, capsys):
    taken = tmp_path / "net.onnx"
    taken.write_bytes(b"mine")
    assert main(["reef", "eyes", "train", "--out", str(taken)]) == 2
    assert "--out: found" in capsys.readouterr().err
    assert taken.read_bytes() == b"mine"


def test_exact_perception_is_not_scored(capsys):
    assert main(["reef", "eyes", "score", "--perception", "exact"]) == 2
    assert "exact perception has no errors" in capsys.readouterr().err


def test_a_calibration_needs_runs_with_their_truth_and_a_new_file(tmp_path, capsys):
    pytest.importorskip("onnxruntime")
    words = ["reef", "eyes", "calibrate", "--out"]
    assert main([*words, str(tmp_path / "net.json")]) == 2
    assert "--out: found" in capsys.readouterr().err
    out = tmp_path / "net.cover.json"
    assert main([*words, str(out)]) == 2
    assert "--runs: found 0 reefs, expected at least 3" in capsys.readouterr().err
    assert main([*words, str(out), "--perception", "exact"]) == 2
    assert "exact perception has no errors" in capsys.readouterr().err
    assert not out.exists()
