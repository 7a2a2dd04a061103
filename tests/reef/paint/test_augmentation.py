import pytest

torch = pytest.importorskip("torch", reason="torch is only for training (extra train)")


def chance(seed=0):
    from coral.reef.paint.augmentation import BatchRandom

    return BatchRandom(seed, torch.device("cpu"))


def test_labels_move_with_the_colours():
    from coral.reef.paint.augmentation import choose_windows, look_through

    marks = torch.zeros(4, 1, 64, 64)
    marks[:, :, 16:48, 8:40] = 1.0
    window = choose_windows(4, chance(), scale=(0.5, 1.5), turned=True)
    light = look_through(marks, window, (64, 64), "bilinear")
    label = look_through(marks, window, (64, 64), "nearest")
    assert ((light > 0.5).float() - label).abs().mean() < 0.02


def test_colours_stay_in_range_and_change():
    from coral.reef.paint.augmentation import paste_titles, vary_colours

    light = torch.full((3, 3, 32, 40), 0.5)
    for depth in (None, torch.full((3, 1, 32, 40), 2.0)):
        varied = vary_colours(light, depth, chance())
        assert varied.shape == light.shape
        assert 0.0 <= float(varied.min()) < float(varied.max()) <= 1.0
    titles = torch.ones(2, 2, 8, 8)
    assert not torch.equal(paste_titles(light, titles, chance(), 1.0), light)
    assert torch.equal(paste_titles(light, titles, chance(), 0.0), light)


def test_a_floor_is_nearer_below():
    from coral.reef.paint.augmentation import random_floor

    floor = random_floor(8, (24, 32), chance())
    assert floor.shape == (8, 1, 24, 32)
    assert (floor[:, :, -1].mean(dim=-1) >= floor[:, :, 0].mean(dim=-1)).all()
