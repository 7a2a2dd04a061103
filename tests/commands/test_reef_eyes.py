"""`coral reef eyes`: refused in time, and what its table says."""

import json

import cv2
import numpy as np
import pytest

from coral.cli import main
from coral.reef.eyes import backends
from coral.reef.eyes.perception import SeenPicture
from coral.reef.world.geometry import Label


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


class Sees:
    """Takes what is bright for oysters; a black picture is unlike all that it knows."""

    def perceive(self, rgb, camera, attitude):
        assert rgb.shape[:2] == (camera.height, camera.width)
        labels = np.where(rgb[..., 0] > 100, np.uint8(Label.OYSTER), np.uint8(Label.SEABED))
        return SeenPicture(labels, np.ones(labels.shape, np.float32), np.zeros(labels.shape, np.float32), not rgb.any())


def test_real_pictures_are_scored_by_video(tmp_path, capsys, monkeypatch):
    rgb, mask = np.zeros((40, 60, 3), np.uint8), np.zeros((40, 60), np.uint8)
    rgb[:, :30], mask[:, :15] = 200, 255
    for name, picture in (("dive_1", rgb), ("dive_2", rgb), ("dark_1", 0 * rgb)):
        cv2.imwrite(str(tmp_path / f"{name}.png"), picture)
        cv2.imwrite(str(tmp_path / f"{name}_mask.png"), mask)
    monkeypatch.setattr(backends, "open_eyes", {"rgb": Sees()}.get)
    assert main(["reef", "eyes", "score", "--labelled", str(tmp_path)]) == 0
    assert capsys.readouterr().out.splitlines()[2:] == [
        "| dark | 0.00 | 0.00 | 0.00 | 0 % | 25 % | 0 of 1 |",
        "| dive | 0.50 | 0.50 | 1.00 | 50 % | 25 % | 2 of 2 |",
    ]
    assert main(["reef", "eyes", "score", "--labelled", str(tmp_path), "--perception", "exact"]) == 2
    assert "a network that sees pictures" in capsys.readouterr().err
