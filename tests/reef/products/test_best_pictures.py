"""The best pictures of each cluster."""

import itertools

from coral.reef.map.chain import ChainCfg
from coral.reef.products.best_pictures import best_pictures
from coral.reef.products.clusters import label_clusters


def test_the_best_come_first_and_apart(products, recording):
    group = label_clusters(products.cells, ChainCfg(), 0.1)
    found = best_pictures(recording, group)
    assert [picture.cluster for picture in found] == [1, 1, 1]
    assert found[0].pixels >= found[1].pixels >= found[2].pixels > 50
    assert all(abs(a.t - b.t) >= 3.0 for a, b in itertools.combinations(found, 2))
    assert found[0].image.shape == (60, 80, 3)
    reddish = found[0].image[..., 0].astype(int) - found[0].image[..., 1] > 100  # shells, as the camera saw them
    assert reddish.sum() > 50


def test_a_map_without_clusters_has_none(recording, products):
    assert best_pictures(recording, label_clusters(products.cells, ChainCfg(min_area_px=10**6), 0.1)) == []
