"""What is said of a survey whose pictures nobody should judge."""

from dataclasses import replace

import numpy as np
import pytest

from coral.reef.products.cover import FINE_M, SurveyEstimate, measure_cover
from coral.reef.products.files import summary
from coral.reef.products.judgement import Judgement, PossibleCover, judge
from coral.reef.products.placement import EarthPlacement
from coral.reef.products.survey_products import ProductsCfg, measure
from coral.reef.world.geometry import Label


def doubted(recording, share):
    """Return a recording whose first pictures, up to a share, are doubted entirely."""

    def keyframes():
        for k, one in enumerate(recording.keyframes()):
            doubt = np.full(one.frame.depth.shape, 1.0 if k < share * 41 else 0.2, np.float32)
            yield replace(one, frame=replace(one.frame, doubt=doubt))

    return replace(recording, keyframes=keyframes, seen_by="net.onnx")


def possible_of(recording):
    cover, _ = measure_cover(recording)
    return judge(recording, cover, np.zeros_like(cover.known))


def test_a_survey_unlike_all_that_is_known_is_not_judged(recording):
    products = measure(doubted(recording, 1.0), ProductsCfg())
    assert products.judgement.unlike == products.keyframes
    assert (
        products.judgement.warning() == "Not judged: 41 of 41 pictures are unlike all that the network was trained on"
    )
    assert products.area.low == products.area.value == 0.0
    assert products.area.high > 1.0
    assert not products.clusters
    told = summary(products, EarthPlacement(products.recording.start))
    assert (told["oyster_area_m2"], told["oysters"]) == (None, None)
    assert told["oyster_area_high_m2"] > 1.0


def test_most_pictures_unlike_what_is_known_are_enough_not_to_judge(recording):
    products = measure(doubted(recording, 0.6), ProductsCfg())
    assert products.area.value > 0.0
    assert products.area.low == 0.0
    assert products.shells.oysters is None
    assert summary(products, EarthPlacement(products.recording.start))["oyster_area_m2"] is None


def test_doubt_widens_the_interval_of_a_network_without_calibration(recording, products):
    judged, made = possible_of(doubted(recording, 0.0))
    assert judged.judged
    assert not made.sure.any()  # every pixel has more doubt than a sure one
    assert made.possible.sum() * FINE_M**2 >= products.area.value * 0.8
    assert possible_of(recording)[1].sure is None  # exact classes have no doubt


def test_doubt_widens_the_interval_of_every_cluster(recording):
    products = measure(doubted(recording, 0.0), ProductsCfg())
    assert products.area.low == 0.0
    assert products.clusters
    assert [one.area.low for one in products.clusters] == [0.0] * len(products.clusters)
    assert max(one.area.high for one in products.clusters) <= products.area.high


def test_an_interval_contains_oysters_of_which_there_are_too_few_pictures(recording, products):
    once = replace(recording, keyframes=lambda: iter([max(recording.keyframes(), key=oysters_in)]))
    found = measure(once, ProductsCfg())
    assert found.area.value == 0.0  # the map asks for two pictures
    assert 0.1 < found.area.high < 2.0 * products.area.high
    soft = replace(once, keyframes=lambda: (with_doubt(one, 0.2) for one in once.keyframes()), seen_by="painted")
    calibrated = measure(soft, ProductsCfg())
    assert calibrated.calibrated_reefs > 0
    assert calibrated.area.high == pytest.approx(found.area.high)


def test_where_every_place_is_seen_often_nothing_is_left_out(recording, products):
    assert products.area.high < 1.3 * products.area.value


def oysters_in(one):
    return np.count_nonzero((one.frame.labels == Label.OYSTER) & (one.frame.depth < 2.0))


def with_doubt(one, value):
    return replace(one, frame=replace(one.frame, doubt=np.full(one.frame.depth.shape, value, np.float32)))


def test_an_interval_is_never_made_narrower(monkeypatch):
    monkeypatch.setattr("coral.reef.products.judgement.FINE_M", 1.0)
    area, cells = SurveyEstimate(2.0, 1.0, 3.0), np.zeros((4, 1), np.bool_)
    known = PossibleCover(np.ones((4, 1), np.float32), cells, cells, None)
    every = ~cells
    assert known.widen(area, every) == area
    assert replace(known, sure=np.full((4, 1), 0.05, np.float32)).widen(area, every) == SurveyEstimate(
        2.0, pytest.approx(0.2), 4.0
    )
    one = np.array([[True], [False], [False], [False]])
    assert replace(known, unjudged=one).widen(area, every) == SurveyEstimate(2.0, 1.0, 4.0)
    assert replace(known, left_out=every).widen(area, every) == SurveyEstimate(2.0, 1.0, 6.0)
    assert replace(known, left_out=every).widen(area, one) == area
    assert Judgement(0, 0).judged
