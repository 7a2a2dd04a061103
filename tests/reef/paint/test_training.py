import numpy as np
import pytest

pytest.importorskip("torch", reason="torch is only for training (extra train)")
pytest.importorskip("onnx", reason="onnx is only for training (extra train)")


def test_training_lowers_the_loss_and_the_file_is_our_layout(tmp_path):
    from coral.onnx_file import open_onnx
    from coral.reef.eyes.reef_net import ReefNetEyes
    from coral.reef.paint.training import TrainingCfg, TrainingData, export, train

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


def test_a_training_goes_on_from_the_weights_beside_the_file(tmp_path):
    import torch

    from coral.reef.paint.training import TrainingCfg, TrainingData, export, train, weights_in
    from coral.reef.paint.unet import ReefNet

    torch.manual_seed(0)
    first = ReefNet()
    export(first, tmp_path / "net.onnx", (32, 16))
    begin = weights_in(tmp_path / "net.pt")
    nothing = TrainingData(
        np.zeros((0, 4, 16, 32), np.float16), np.zeros((0, 16, 32), np.uint8), np.zeros((0, 16, 32), np.float16)
    )
    net = train(nothing, TrainingCfg(epochs=1, threads=1), 5, lambda _: None, begin)
    assert all(torch.equal(a, b) for a, b in zip(net.parameters(), first.parameters(), strict=True))


@pytest.mark.parametrize("content", [b"", b"weights", None])
def test_a_file_without_our_weights_is_named(tmp_path, content):
    from coral.errors import InputError
    from coral.reef.paint.training import weights_in

    if content is not None:
        (tmp_path / "net.pt").write_bytes(content)
    with pytest.raises(InputError, match=r"--begin: found .*net\.pt.*expected weights of our network"):
        weights_in(tmp_path / "net.pt")


def test_the_overlap_of_a_sure_guess_is_that_of_its_pixels():
    import torch

    from coral.reef.paint.training import _overlap_loss

    labels = torch.zeros((1, 10, 10), dtype=torch.long)
    labels[0, :6] = 1
    guess = torch.zeros((1, 10, 10), dtype=torch.long)
    guess[0, 3:9] = 1
    logits = 50.0 * torch.nn.functional.one_hot(guess, 4).permute(0, 3, 1, 2).float()
    assert float(_overlap_loss(logits, labels)) == pytest.approx(1.0 - 31.0 / 91.0, abs=1e-3)
