"""Networks of one's own in a mission, a wing: `coral.reef.networks`."""

import pytest

from coral.reef.eyes.ground_plane import ground_depth
from coral.reef.vehicle.camera import CameraCfg
from onnx_files import red_is_oyster_yolo, relative_depth


@pytest.mark.slow
def test_networks_of_ones_own_see_for_a_mission(told, tmp_path):
    pytest.importorskip("onnxruntime")
    (tmp_path / "yolo.onnx").write_bytes(red_is_oyster_yolo(64))
    inverse = 1.0 / ground_depth(CameraCfg(width=56, height=42))
    (tmp_path / "depth.onnx").write_bytes(relative_depth(4.0 * inverse + 1.0))
    words = ["reef", "run", "s1", "--perception", tmp_path / "yolo.onnx", "--depth", tmp_path / "depth.onnx", "--sonar"]
    short = ["--cfg.time-limit-s", "0.3", "--cfg.record.no-report", "--json"]
    code, result, error = told(*words, *short, "--out", tmp_path / "run")
    assert code == 0, error
    assert "classes: 0 oyster: oyster; 1 rock: obstacle" in error
    assert "a depth network, relative as the shipped picture shows" in error
    assert result["steps"] == 3
    config = (tmp_path / "run/config.yaml").read_text()
    assert "yolo.onnx" in config
    assert "depth.onnx" in config
    code, _, error = told("reef", "run", "s1", "--depth", tmp_path / "depth.onnx", *short, "--out", tmp_path / "other")
    assert (code, error.count("\n")) == (2, 1)
    assert "--perception painted, rgb or FILE.onnx, for the classes" in error
