import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="torch is only for training (extra train)")
pytest.importorskip("onnx", reason="onnx is only for training (extra train)")


def test_known_pictures_are_near_and_others_are_not():
    from coral.reef.paint.familiar import remember
    from coral.reef.paint.unet import ReefNet

    rng, net = np.random.default_rng(0), ReefNet()
    size = net.middle.numel()
    real, painted = rng.normal(0.0, 1.0, (60, size)), rng.normal(5.0, 1.0, (40, size))
    remember(net, real, np.array(["a", "b", "c"] * 20), painted, 0)
    strange = rng.normal(-9.0, 1.0, (5, size))

    def unlike(points):
        return net.unlike(torch.from_numpy(points).float()).numpy()

    assert (unlike(real)[:, 0] < unlike(real)[:, 1]).all()
    assert (unlike(painted)[:, 1] < 1.0).all()
    assert (unlike(strange) > 1.0).all()


def test_the_limit_is_measured_across_videos():
    from coral.reef.paint.familiar import left_out_distances

    points = np.array([[0.0], [0.1], [5.0], [5.2]])
    np.testing.assert_allclose(left_out_distances(points, np.array(["a", "a", "b", "b"])), [5.0, 4.9, 4.9, 5.1])


def test_nothing_is_near_a_set_that_is_empty():
    from coral.reef.paint.familiar import remember
    from coral.reef.paint.unet import ReefNet

    net = ReefNet()
    painted = np.random.default_rng(0).normal(0.0, 1.0, (30, net.middle.numel()))
    remember(net, painted[:0], np.array([], np.str_), painted, 0)
    apart = net.unlike(torch.from_numpy(painted).float()).detach().numpy()
    assert (apart[:, 0] > 100).all()
    assert (apart[:, 1] < 1).all()


def test_more_pictures_become_familiar_and_the_others_stay_so(monkeypatch):
    from coral.reef.paint import familiar
    from coral.reef.paint.labelled_pictures import LabelledPicture
    from coral.reef.paint.unet import ReefNet

    rng, net = np.random.default_rng(0), ReefNet()
    size = net.middle.numel()
    known, new = rng.normal(0.0, 1.0, (60, size)), rng.normal(-9.0, 1.0, (1, size)).astype(np.float32)
    familiar.remember(net, known, np.array(["a", "b", "c"] * 20), known + 20.0, 0)

    def unlike(points):
        return net.unlike(torch.from_numpy(points).float()).numpy()[:, 0]

    assert (unlike(new) > 1).all()
    monkeypatch.setattr(familiar, "describe_picture", lambda net, picture: new)
    familiar.know_more(net, [LabelledPicture("d-1", np.zeros((48, 64, 3), np.uint8), np.zeros((48, 64), np.uint8))], 0)
    assert (unlike(new) < 0.01).all()
    assert (unlike(known) < 1).mean() > 0.9


def test_a_network_that_calls_all_oyster_has_full_recall_and_the_precision_of_the_share():
    from coral.reef.paint.collage import OTHER
    from coral.reef.paint.familiar import measure_left_out
    from coral.reef.paint.labelled_pictures import LabelledPicture
    from coral.reef.paint.unet import ReefNet
    from coral.reef.world.geometry import Label

    net = ReefNet().eval()
    net.lean[int(Label.OYSTER)] = 1e3
    target = np.full((40, 60), OTHER, np.uint8)
    target[:, :30] = int(Label.OYSTER)
    rows = measure_left_out(net, [LabelledPicture(f"v-{k}", np.zeros((40, 60, 3), np.uint8), target) for k in (1, 2)])
    assert rows == [{"video": "v", "iou": 0.5, "precision": 0.5, "recall": 1.0, "said": 1.0, "true": 0.5}]
