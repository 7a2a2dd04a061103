import numpy as np
import pytest

from coral.view.contact.lerobot_stats import QUANTILES, PictureStats, column_stats


def test_a_column_has_moments_and_quantiles_by_number():
    rows = np.random.default_rng(0).normal(size=(101, 2))
    found = column_stats(rows.tolist())
    assert found["mean"] == pytest.approx(rows.mean(axis=0))
    assert found["std"] == pytest.approx(rows.std(axis=0))
    assert found["q50"] == pytest.approx(np.median(rows, axis=0))
    assert found["count"] == [101]
    assert len(column_stats([True, False])["q99"]) == 1


def test_pictures_have_what_all_their_pixels_together_give():
    pictures = np.random.default_rng(1).integers(3, 250, (4, 6, 5, 3)).astype(np.uint8)
    stats = PictureStats()
    for picture in pictures:
        stats.add(picture)
    found, pixels = stats.stats(), pictures.reshape(-1, 3) / 255
    assert np.shape(found["mean"]) == (3, 1, 1)
    assert np.ravel(found["mean"]) == pytest.approx(pixels.mean(axis=0))
    assert np.ravel(found["std"]) == pytest.approx(pixels.std(axis=0))
    assert np.ravel(found["min"]) == pytest.approx(pixels.min(axis=0))
    assert np.ravel(found["max"]) == pytest.approx(pixels.max(axis=0))
    for name, share in QUANTILES.items():
        expected = np.quantile(pixels, share, axis=0, method="inverted_cdf")
        assert np.ravel(found[name]) == pytest.approx(expected)
    assert found["count"] == [4]
