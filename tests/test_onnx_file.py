import sys

import numpy as np
import pytest

from coral.errors import InputError
from coral.onnx_file import open_onnx, open_picture_network
from coral.reef.eyes.reef_net import SHIPPED
from onnx_files import model, node, red_is_oyster


def test_the_shipped_network_tells_its_layout():
    pytest.importorskip("onnxruntime")
    file = open_onnx(SHIPPED)
    assert file.inputs == {"picture": (1, 4, 120, 160)}
    assert file.outputs["logits"] == (1, 4, 120, 160)


def test_a_missing_and_a_broken_file_are_one_clear_line(tmp_path):
    pytest.importorskip("onnxruntime")
    with pytest.raises(InputError, match="found no file, expected an ONNX file"):
        open_onnx(tmp_path / "none.onnx")
    broken = tmp_path / "broken.onnx"
    broken.write_bytes(b"nonsense")
    with pytest.raises(InputError, match="onnxruntime refuses"):
        open_onnx(broken)


def test_without_onnxruntime_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "onnxruntime", None)
    with pytest.raises(InputError, match=r"--perception: found no package onnxruntime, expected the extra vision"):
        open_onnx(SHIPPED)


def test_shapes_that_a_network_refuses_are_one_clear_line():
    pytest.importorskip("onnxruntime")
    with pytest.raises(InputError, match="shapes that it refuses"):
        open_onnx(SHIPPED).run(np.zeros((1, 3, 8, 8), np.float32))


def test_a_network_of_several_inputs_takes_no_picture_alone(tmp_path):
    pytest.importorskip("onnxruntime")
    shape = (1, 3, 8, 8)
    pair = model([node("Add", ["a", "b"], ["y"])], {}, {"a": shape, "b": shape}, {"y": shape})
    (tmp_path / "decoder.onnx").write_bytes(pair)
    with pytest.raises(InputError, match=r"one float input of shape \(1, channels, height, width\)"):
        open_picture_network(tmp_path / "decoder.onnx")


def test_half_precision_is_converted_and_open_shapes_are_found_by_a_look(tmp_path):
    pytest.importorskip("onnxruntime")
    (tmp_path / "half.onnx").write_bytes(red_is_oyster("w", "h", half=True))
    file = open_picture_network(tmp_path / "half.onnx")
    assert file.outputs == {"logits": (1, 4, None, None)}
    assert file.with_shapes_of(12, 8).outputs == {"logits": (1, 4, 8, 12)}
    assert file.run(np.zeros((1, 3, 8, 12), np.float32))["logits"].dtype == np.float32


def test_a_network_for_several_pictures_at_once_is_refused(tmp_path):
    pytest.importorskip("onnxruntime")
    shape = (2, 3, 8, 8)
    (tmp_path / "two.onnx").write_bytes(model([node("Identity", ["x"], ["y"])], {}, {"x": shape}, {"y": shape}))
    with pytest.raises(InputError, match=r"found x tensor\(float\) \(2, 3, 8, 8\), expected one float input"):
        open_picture_network(tmp_path / "two.onnx")
