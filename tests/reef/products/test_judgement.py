"""What is said of a survey whose pictures nobody should judge."""

from dataclasses import replace

import numpy as np
import pytest

from coral.reef.products.cover import Area, CoverCfg
from coral.reef.products.judgement import Judgement, judge
from coral.reef.products.survey_products import ProductsCfg, measure


def doubted(recording, share):
    """Return a recording whose first pictures, up to a share, are doubted entirely."""

    def keyframes():
        for k, one in enumerate(recording.keyframes()):
            doubt = np.full(one.frame.depth.shape, 1.0 if k < share * 41 else 0.2, np.float32)
            yield replace(one, frame=replace(one.frame, doubt=doubt))

    return replace(recording, keyframes=keyframes, seen_by="net.onnx")


def test_a_survey_unlike_all_that_is_known_is_not_judged(recording):
    products = measure(doubted(recording, 1.0), ProductsCfg())
    assert products.judgement.unlike == products.keyframes
    assert (
        products.judgement.warning() == "Not judged: 41 of 41 pictures are unlike all that the network was trained on"
    )
    assert products.area.low_m2 == products.area.m2 == 0.0
    assert products.area.high_m2 == pytest.approx(products.judgement.unjudged_m2)
    assert products.area.high_m2 > 1.0
    assert not products.clusters


def test_doubt_widens_the_interval_of_a_network_without_calibration(recording, products):
    made = judge(doubted(recording, 0.0), CoverCfg(), calibrated=False)
    assert made.judged
    assert made.sure_m2 == 0.0  # every pixel has more doubt than a sure one
    assert made.possible_m2 >= products.area.m2 * 0.8
    assert judge(recording, CoverCfg(), calibrated=False).sure_m2 is None  # exact classes have no doubt


def test_an_interval_is_never_made_narrower():
    area = Area(2.0, 1.0, 3.0)
    assert Judgement(10, 0).widen(area) == area
    assert Judgement(10, 4, 0.5, 0.2, 2.5).widen(area) == Area(2.0, 0.2, 3.5)
    assert Judgement(10, 6, 0.5, 1.5, 2.5).widen(area) == Area(2.0, 0.0, 3.5)
    assert Judgement(0, 0).judged
