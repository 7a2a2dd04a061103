import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coral.reef.map.chain import (
    CentroidTracker,
    ChainCfg,
    Component,
    InspectCfg,
    components,
    order_chain,
    spanning_tree,
)

CELL = 0.05


def disc():
    """A round patch of oysters, one metre across."""
    iy, ix = np.mgrid[:100, :100]
    return (iy - 50) ** 2 + (ix - 50) ** 2 <= 100


def component(x, y):
    return Component(x=x, y=y, area_px=200, length_m=1.0)


def test_centroid_is_the_mean_of_the_pixels():
    target = np.zeros((100, 100), bool)
    target[20:40, 30:70] = True
    (found,) = components(target, CELL, ChainCfg())
    assert found.area_px == 800
    assert (found.x, found.y) == pytest.approx((50 * CELL, 30 * CELL))
    assert found.length_m == pytest.approx(2.0)


def test_regions_below_a_min_are_noise():
    target = np.zeros((100, 100), bool)
    target[10:19, 10:21] = True
    assert components(target, CELL, ChainCfg()) == []
    target[10:20, 10:20] = True
    assert len(components(target, CELL, ChainCfg())) == 1


def test_separate_oysters_of_a_bed_are_one_cluster():
    target = np.zeros((100, 100), bool)
    for y in range(20, 60, 6):
        for x in range(20, 60, 6):
            target[y : y + 3, x : x + 3] = True
    assert len(components(target, CELL, ChainCfg())) == 1


def test_two_beds_a_metre_apart_stay_two():
    target = np.zeros((100, 100), bool)
    target[20:40, 10:40] = True
    target[20:40, 60:90] = True
    assert len(components(target, CELL, ChainCfg())) == 2


def test_chain_follows_a_curve():
    t = np.linspace(0, np.pi, 8)
    points = np.stack([5 * np.cos(t), 5 * np.sin(t)], axis=1)
    shuffled = np.random.default_rng(1).permutation(8)
    order = order_chain(points[shuffled])
    along = [int(shuffled[i]) for i in order]
    assert along in (list(range(8)), list(range(7, -1, -1)))


@given(st.lists(st.tuples(st.floats(-50, 50), st.floats(-50, 50)), max_size=12))
def test_chain_visits_every_point_once(points):
    assert sorted(order_chain(np.array(points).reshape(-1, 2))) == list(range(len(points)))


def test_equation_3_smooths_the_position():
    tracker = CentroidTracker(ChainCfg(alpha_new=0.3))
    tracker.update([component(2.0, 2.0)])
    (track,) = tracker.update([component(3.0, 2.0)])
    assert track.x == pytest.approx(0.7 * 2.0 + 0.3 * 3.0)


def test_labels_survive_reordering_and_new_clusters():
    tracker = CentroidTracker()
    tracker.update([component(1.0, 1.0), component(5.0, 1.0)])
    tracks = tracker.update([component(9.0, 1.0), component(5.1, 1.0), component(1.1, 1.0)])
    assert {t.index: round(t.x) for t in tracks} == {0: 1, 1: 5, 2: 9}


def test_each_component_matches_one_track():
    tracker = CentroidTracker()
    tracker.update([component(1.0, 1.0)])
    tracks = tracker.update([component(1.2, 1.0), component(1.6, 1.0)])
    assert sorted(t.index for t in tracks) == [0, 1]


def test_unmatched_tracks_expire_and_their_label_is_never_used_again():
    tracker = CentroidTracker(ChainCfg(drop_after=3))
    tracker.update([component(1.0, 1.0), component(5.0, 1.0)])
    for _ in range(2):
        assert len(tracker.update([component(5.0, 1.0)])) == 2
    assert [t.index for t in tracker.update([component(5.0, 1.0)])] == [1]
    assert [t.index for t in tracker.update([component(5.0, 1.0), component(9.0, 9.0)])] == [1, 2]


def test_at_the_end_there_is_what_the_map_shows_or_what_was_seen_from_afar():
    tracker = CentroidTracker()
    tracker.update([component(1.0, 1.0), component(5.0, 1.0)], [(9.0, 1.0)])
    tracker.update([component(5.0, 1.0)], [(9.0, 1.0)])
    tracker.settle()
    assert [(t.index, t.far) for t in tracker.tracks] == [(1, False), (2, True)]


def test_what_was_seen_from_afar_keeps_its_label_when_the_map_shows_it():
    tracker = CentroidTracker()
    tracker.update([component(1.0, 1.0)], [(9.0, 1.0)])
    assert [(t.index, t.far) for t in tracker.tracks] == [(0, False), (1, True)]
    tracker.update([component(1.0, 1.0), component(8.0, 2.0)], [(9.0, 1.0)])
    assert [(t.index, t.far, t.x) for t in tracker.tracks] == [(0, False, 1.0), (1, False, 8.0)]


def test_what_was_seen_from_afar_goes_when_nothing_is_there():
    tracker = CentroidTracker()
    tracker.update([], [(9.0, 1.0)])
    assert tracker.update([]) == []


def test_a_cluster_is_done_once_its_cells_were_seen_from_near():
    tracker, cfg = CentroidTracker(), InspectCfg(share=0.9, least_m2=0.0)
    tracker.update(components(disc(), 0.05, ChainCfg()))
    nearest, unseeable = np.full(disc().shape, 3.0, np.float32), np.zeros(disc().shape, bool)
    (track,) = tracker.tracks
    cells = track.cells
    half = len(cells) // 2
    nearest[cells[:half, 0], cells[:half, 1]] = 2.0
    tracker.inspect(nearest, unseeable, 2.3, 0.05, cfg)
    (track,) = tracker.tracks
    assert track.inspected == pytest.approx(0.5, abs=0.01)
    assert not track.visited
    assert len(track.left) == len(cells) - half
    unseeable[cells[half:, 0], cells[half:, 1]] = True  # given up: done, but not seen
    tracker.inspect(nearest, unseeable, 2.3, 0.05, cfg)
    assert tracker.tracks[0].visited
    assert tracker.tracks[0].inspected == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize(("agreement", "doubtful"), [(0.2, True), (0.4, False)])
def test_a_cluster_is_doubtful_while_pictures_disagree_about_its_cells(agreement, doubtful):
    tracker = CentroidTracker()
    tracker.update(components(disc(), 0.05, ChainCfg()))
    asked = []
    tracker.doubt(lambda cells: asked.append(len(cells)) or agreement, 0.33)
    assert tracker.tracks[0].doubtful == doubtful
    assert asked == [int(disc().sum())]


def test_the_tree_joins_all_points_by_the_shortest_links():
    points = np.array([[0.0, 0.0], [2.0, 0.0], [4.0, 0.0], [2.0, 2.5]])
    assert {frozenset(link) for link in spanning_tree(points)} == {frozenset(p) for p in ((0, 1), (1, 2), (1, 3))}
    assert spanning_tree(points[:1]) == []


def test_one_cluster_that_is_seen_from_afar_twice_has_one_dot():
    tracker = CentroidTracker()
    tracker.update([], [(8.0, 4.0), (9.2, 4.0)])
    assert [(t.x, t.far) for t in tracker.tracks] == [(8.0, True)]
    tracker.update([], [(8.1, 4.0), (13.0, 4.0)])
    assert [t.index for t in tracker.tracks] == [0, 1]
