import numpy as np
import pytest

pytest.importorskip("torch", reason="torch is only for training (extra train)")
pytest.importorskip("onnx", reason="onnx is only for training (extra train)")


def test_training_lowers_the_loss_and_the_file_is_our_layout(tmp_path):
    from coral.reef.eyes.onnx_file import open_onnx
    from coral.reef.eyes.reef_net import ReefNetEyes
    from coral.reef.eyes.training import TrainingCfg, TrainingData, export, train

    rng = np.random.default_rng(0)
    labels = rng.integers(0, 4, (8, 16, 32)).astype(np.uint8)
    pictures = np.zeros((8, 4, 16, 32), np.float16)
    pictures[:, 0], pictures[:, 3] = labels / 2.0 - 1.0, 0.5
    depth = np.where(labels == 0, np.inf, 2.0).astype(np.float16)
    told: list[str] = []
    net = train(TrainingData(pictures, labels, depth), TrainingCfg(epochs=6, threads=1), 0, told.append)
    losses = [float(line.split("classes ")[1].split(",")[0]) for line in told]
    assert losses[-1] < losses[0]
    export(net, tmp_path / "net.onnx", (32, 16))
    assert ReefNetEyes(open_onnx(tmp_path / "net.onnx")).size == (32, 16)
