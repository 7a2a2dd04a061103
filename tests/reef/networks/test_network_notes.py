import json
from dataclasses import replace

import numpy as np
import pytest
from given_networks import given

from coral.errors import InputError
from coral.reef.networks.network_notes import BYTES, IMAGENET, UNIT, PictureInput, read_notes


def network(folder, metadata=None, beside=None):
    for name, content in (beside or {}).items():
        (folder / name).write_text(content if isinstance(content, str) else json.dumps(content))
    (folder / "onnx").mkdir(exist_ok=True)
    path = str(folder / "onnx" / "model.onnx")
    return replace(given({"y": np.zeros((1, 4, 2, 4), np.float32)}, metadata=metadata), path=path)


def test_metadata_of_ultralytics(tmp_path):
    metadata = {"names": "{0: 'oyster'}", "task": "segment", "imgsz": "[480, 640]", "args": "{'nms': True}"}
    notes = read_notes(network(tmp_path, metadata))
    assert (notes.names, notes.task, notes.size, notes.suppressed) == ({0: "oyster"}, "segment", (640, 480), True)
    assert read_notes(network(tmp_path, {"args": "{'nms': False}", "end2end": "False"})).suppressed is False
    assert read_notes(network(tmp_path, {"args": "{", "imgsz": "640"})).suppressed is None


def test_files_of_transformers_lie_one_folder_up(tmp_path):
    beside = {
        "config.json": {"model_type": "segformer", "id2label": {"0": "sand", "1": "oyster"}},
        "preprocessor_config.json": {
            "size": {"height": 512, "width": 384}, "image_mean": list(IMAGENET.mean), "image_std": list(IMAGENET.spread)
        },
    }  # fmt: skip
    notes = read_notes(network(tmp_path, beside=beside))
    assert notes.names == {0: "sand", 1: "oyster"}
    assert notes.size == (384, 512)
    assert notes.picture_input(UNIT) == IMAGENET


def test_another_programs_config_says_nothing(tmp_path):
    assert read_notes(network(tmp_path, beside={"config.json": {"id2label": {"0": "oyster"}}})).names == {}


def test_a_user_wins_over_the_export_but_not_against_the_truth_of_it(tmp_path):
    beside = {"config.json": {"model_type": "depth_anything", "depth_estimation_type": "metric"}}
    assert read_notes(network(tmp_path, beside=beside)).depth == "metric"
    (tmp_path / "onnx" / "model.eyes.yaml").write_text("depth: relative\nchannels: bgr\n")
    with pytest.raises(InputError, match=r"relative in \.eyes\.yaml, expected metric"):
        read_notes(network(tmp_path, beside=beside))
    (tmp_path / "config.json").unlink()
    assert read_notes(network(tmp_path)).picture_input(UNIT).describe() == "BGR, 0 to 1"


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("onnx/model.eyes.yaml", "channels: gbr"),
        ("onnx/model.eyes.yaml", "klasses: {}"),
        ("preprocessor_config.json", '{"image_mean": [0.5]}'),
        ("config.json", "{"),
    ],
)
def test_a_broken_file_is_one_clear_line(tmp_path, name, content):
    file = network(tmp_path)
    (tmp_path / name).write_text(content)
    with pytest.raises(InputError, match="found"):
        read_notes(file)


def test_values_by_hand():
    rgb = np.array([[[255, 51, 0]]], np.uint8)
    assert UNIT.tensor(rgb).ravel().tolist() == pytest.approx([1.0, 0.2, 0.0])
    assert BYTES.tensor(rgb).ravel().tolist() == [255.0, 51.0, 0.0]
    assert IMAGENET.tensor(rgb).ravel()[0] == pytest.approx((1.0 - 0.485) / 0.229)
    assert PictureInput("0 to 1", bgr=True).tensor(rgb).ravel().tolist() == pytest.approx([0.0, 0.2, 1.0])
    assert UNIT.tensor(rgb).shape == (1, 3, 1, 1)
