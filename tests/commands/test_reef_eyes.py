"""`coral reef eyes`: refused in time, and what its table says."""

import json

import pytest

from coral.cli import main


def test_a_score_is_one_json_object_with_a_row_for_each_water(capsys):
    pytest.importorskip("onnxruntime")
    words = ["reef", "eyes", "score", "--worlds", "s1", "--waters", "clear", "bay", "--pictures", "1", "--json"]
    assert main(words) == 0
    result = json.loads(capsys.readouterr().out)
    row, _ = result["rows"]
    assert (row["water"], row["pictures"]) == ("jerlov-IB", 1)
    assert len(row["oyster_iou"]) == len(result["bands_m"]) - 1


def test_training_refuses_a_file_that_exists(tmp_path, capsys):
    taken = tmp_path / "net.onnx"
    taken.write_bytes(b"mine")
    assert main(["reef", "eyes", "train", "--out", str(taken)]) == 2
    assert "--out: found" in capsys.readouterr().err
    assert taken.read_bytes() == b"mine"


def test_exact_perception_is_not_scored(capsys):
    assert main(["reef", "eyes", "score", "--perception", "exact"]) == 2
    assert "exact perception has no errors" in capsys.readouterr().err
