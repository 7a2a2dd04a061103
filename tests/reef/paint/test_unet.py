import pytest

torch = pytest.importorskip("torch", reason="torch is only for training (extra train)")


def test_the_depth_of_an_untrained_correction_is_that_of_the_floor():
    from coral.reef.paint.unet import CLASSES, ReefNet

    net = ReefNet().eval()
    torch.nn.init.zeros_(net.head.weight)
    torch.nn.init.zeros_(net.head.bias)
    picture = torch.zeros(1, 4, 30, 46)  # no multiple of 32: sizes of all levels are cut to fit
    picture[:, 3] = 0.5  # 2 m
    logits, depth, doubt, unlike = net(picture)
    assert logits.shape == (1, CLASSES, 30, 46)
    assert torch.allclose(depth, torch.full((1, 1, 30, 46), 2.0))
    assert (doubt > 0).all()
    assert unlike.shape == (1, 2)
