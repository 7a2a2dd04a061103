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


def test_the_encoder_begins_with_given_weights_and_no_weight_on_the_depth_of_the_floor():
    from coral.reef.paint.unet import ReefNet

    net = ReefNet()
    names = {name for name in net.down.state_dict() if not name.endswith("num_batches_tracked")}
    given = {name: torch.rand_like(value) for name, value in net.down.state_dict().items() if name in names}
    first = next(iter(given))
    given[first] = given[first][:, :3]
    net.begin_with({**given, "_conv_head.weight": torch.zeros(2)})
    taken = net.down.state_dict()
    assert torch.equal(taken[first][:, :3], given[first])
    assert not taken[first][:, 3].any()
    assert all(torch.equal(taken[name], value) for name, value in given.items() if name != first)


def test_a_cast_of_colour_hardly_changes_anything():
    from coral.reef.paint.unet import ReefNet

    net, picture = ReefNet().eval(), torch.rand(1, 4, 32, 48)
    green = picture.clone()
    green[:, 1] = green[:, 1] * 0.8 + 0.2
    with torch.no_grad():
        seen, cast = net(picture)[0], net(green)[0]
    assert (seen - cast).abs().max() < 0.1 * seen.abs().max()
