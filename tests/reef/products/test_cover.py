"""Area of oysters from pictures, and its interval."""

import math
from dataclasses import replace

import numpy as np
import pytest

from coral.reef.products.cover import (
    BINS,
    FINE_M,
    Cover,
    CoverCalibration,
    Votes,
    area_within,
    bins_of,
    find_calibration,
    fine_of,
    make_cover,
    measure_cover,
    oyster_probability,
    vote,
)
from coral.reef.products.seen_points import find_points, lens_of, transform_of
from coral.reef.products.truth import true_oysters
from coral.reef.recordings.recorded_pictures import NO_OBJECTS
from coral.reef.world.geometry import Frame, Label
from coral.reef.world.world import load_world

CALIBRATION = CoverCalibration(tuple(k / BINS for k in range(BINS)), 0.03, 0.1, 4, "by hand")


def test_the_area_is_near_the_truth_and_in_its_interval(products, survey_run):
    truth = true_oysters(load_world(survey_run / "world.yaml"), products.seen, FINE_M).whole_m2
    assert products.area.value == pytest.approx(truth, rel=0.1)
    assert products.area.low < truth < products.area.high
    # Whole cells that a shell touches are far more.
    assert products.cells.target.sum() * 0.05**2 > 1.2 * truth


def test_the_interval_is_the_unknown_and_the_sampling_error(monkeypatch):
    monkeypatch.setattr("coral.reef.products.cover.FINE_M", 0.1)
    monkeypatch.setattr("coral.reef.products.cover.EDGE", 0.0)
    seen, filled = np.zeros((10, 10), np.float32), np.zeros((10, 10), np.float32)
    seen[:2], filled[:4] = 1.0, 1.0  # 0.2 m² seen, 0.4 m² at most

    def cover(low, high):
        return Cover(low, high, np.ones((10, 10), bool))

    everything = np.ones((10, 10), bool)
    alone = area_within(cover(seen, filled), [], everything)
    assert alone.value == pytest.approx(0.3)
    assert alone.high - alone.value == pytest.approx(1.96 * 0.2 / math.sqrt(12), rel=1e-5)
    with monkeypatch.context() as rougher:
        rougher.setattr("coral.reef.products.cover.EDGE", 0.1)
        rough = area_within(cover(seen, filled), [], everything)
    assert rough.value - rough.low == pytest.approx(1.96 * math.hypot(0.2 / math.sqrt(12), 0.03), rel=1e-5)
    # Two replicates of 0.28 and 0.32 m²: delete-a-group variance 1/2 (0.02² + 0.02²).
    less, more = cover(seen * 0.8, filled), cover(seen * 1.2, filled)
    both = area_within(cover(seen, filled), [less, more], everything)
    assert both.value - both.low == pytest.approx(1.96 * math.hypot(0.2 / math.sqrt(12), 0.02), rel=1e-5)


def test_each_subset_is_left_out_once(recording, monkeypatch):
    whole, without = measure_cover(recording)
    monkeypatch.setattr("coral.reef.products.cover.SUBSETS", 1)
    alone, none = measure_cover(recording)
    assert (len(without), len(none)) == (8, 0)
    np.testing.assert_allclose(whole.seen, alone.seen, atol=1e-3)
    assert all(np.count_nonzero(one.known) <= np.count_nonzero(whole.known) for one in without)


def test_map_cells_on_the_fine_cells():
    cells = np.array([[True, False], [False, True]])
    cover = Cover(np.zeros((5, 5), np.float32), np.zeros((5, 5), np.float32), np.ones((5, 5), bool))
    fine = fine_of(cells, 0.05, cover)
    assert fine[0, 0]
    assert fine[1, 1]
    assert not fine[0, 4]
    assert fine[4, 4]


def test_votes_are_those_of_a_plain_loop(recording):
    one = next(iter(recording.keyframes()))
    transform, (focal, cx, cy) = transform_of(one, recording), lens_of(recording)
    empty = np.zeros((400, 450), np.float32)
    votes = Votes(empty, empty.copy(), np.full((400, 450), np.inf, np.float32))
    depth = one.frame.depth
    doubt = np.random.default_rng(0).uniform(0.0, 0.5, depth.shape).astype(np.float32)
    likely = oyster_probability(replace(one.frame, doubt=doubt), soft=True)
    cell = find_points(one, recording, 0.02, (400, 450), 3.0).cell
    vote(cell, depth, likely, votes)
    v, u = np.indices(depth.shape)
    z = np.where(np.isfinite(depth), depth, 0.0).astype(float)
    points = np.stack([(u - cx) / focal * z, (v - cy) / focal * z, z], axis=-1)
    near = (np.linalg.norm(points, axis=-1) <= 3.0) & (z > 0.0)
    world = points @ transform[:3, :3].T + transform[:3, 3]
    chosen = near & ~np.isnan(likely)
    for share, made in ((likely, votes.oyster), (1 - likely, votes.floor)):
        expected = np.zeros((400, 450))
        at = np.floor(world[chosen][:, :2] / 0.02).astype(int)
        inside = (at >= 0).all(axis=1) & (at[:, 0] < 450) & (at[:, 1] < 400)
        np.add.at(expected, (at[inside, 1], at[inside, 0]), share[chosen][inside] / z[chosen][inside] ** 2)
        np.testing.assert_allclose(made, expected, rtol=1e-4, atol=1e-5)
    least = np.full((400, 450), np.inf)
    np.minimum.at(least, (at[inside, 1], at[inside, 0]), z[chosen][inside])
    np.testing.assert_allclose(votes.nearest_m, least, rtol=1e-6)


def test_a_pixel_votes_as_its_network_believes():
    labels = np.array([[Label.OYSTER, Label.SEABED, Label.OBSTACLE, Label.WATER]], np.uint8)
    frame = Frame(np.ones((1, 4), np.float32), labels, NO_OBJECTS, doubt=np.full((1, 4), 0.25, np.float32))
    np.testing.assert_allclose(oyster_probability(frame, soft=True), [[0.75, 0.25, np.nan, np.nan]])
    np.testing.assert_allclose(oyster_probability(frame, soft=False), [[1.0, 0.0, np.nan, np.nan]])


def test_a_calibrated_share_is_what_it_has_meant(monkeypatch):
    monkeypatch.setattr("coral.reef.products.cover.EDGE", 0.0)
    votes = Votes(*(np.full((10, 10), value, np.float32) for value in (9.0, 1.0, 0.7)))
    table = np.zeros(BINS)
    table[bins_of(np.float32(0.9), np.float32(0.7))] = 0.4
    calibration = CoverCalibration(tuple(table.tolist()), 0.3, 0.0, 1, "")
    plain, calibrated = make_cover(votes), make_cover(votes, calibration)
    assert plain.seen[5, 5] == pytest.approx(0.9)
    np.testing.assert_allclose(calibrated.seen, 0.4)
    np.testing.assert_allclose(calibrated.filled, 0.4)
    area = area_within(calibrated, [], np.ones((10, 10), bool))
    assert area.value == pytest.approx(100 * 0.02**2 * 0.4)
    # One reef: its error counts twice over, as that of the calibration and as that of this reef.
    assert area.high - area.value == pytest.approx(1.96 * math.sqrt(2.0) * 0.3 * area.value)


def test_what_a_calibrated_network_saw_without_doubt_counts_as_it_is(recording):
    plain, _ = measure_cover(recording)
    called_rgb, _ = measure_cover(replace(recording, seen_by="painted"))
    assert called_rgb.calibration is None
    np.testing.assert_array_equal(called_rgb.seen, plain.seen)


def test_cells_fall_into_bins_by_share_and_distance():
    shares, depths = np.array([0.0, 0.005, 1.0, 1.0], np.float32), np.array([0.5, 0.9, 0.5, np.inf], np.float32)
    np.testing.assert_array_equal(bins_of(shares, depths), [0, 1, BINS - 8, BINS - 1])
    np.testing.assert_allclose(
        CALIBRATION.apply(shares, depths), np.array([0, 1, BINS - 8, BINS - 1]) / BINS, rtol=1e-6
    )


def test_an_area_errs_by_what_its_reef_shares_and_by_its_parts():
    assert CALIBRATION.std_m2(4.0) == pytest.approx(math.sqrt(1.25 * ((0.03 * 4.0) ** 2 + 0.1**2 * 4.0)))
    assert CALIBRATION.std_m2(0.0) == 0.0


def test_the_shipped_network_is_calibrated():
    cover = np.array(find_calibration("painted").cover).reshape(-1, 8)
    assert cover.shape == (15, 8)
    # It takes too much for oysters: even where all votes are for them, shells cover less.
    assert 0.3 < cover[-1, 0] < 0.95
    assert cover[0].max() < 0.05
    assert find_calibration("other.onnx") is None
