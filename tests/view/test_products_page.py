"""The products as a page."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "reef"))

from survey_runs import write_run

from coral.reef.products.judgement import Judgement
from coral.reef.products.placement import Datum, EarthPlacement
from coral.reef.products.survey_products import ProductsCfg, measure
from coral.reef.recordings.run_recording import read_run
from coral.reef.world.world import load_world
from coral.view.products_page import COVER_STOPS, UNSEEN, TruthComparison, ramp, write_products_page

pytest.importorskip("pyproj")


@pytest.fixture(scope="module")
def survey_run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("survey") / "patch-001"
    write_run(folder)
    return folder


@pytest.fixture(scope="module")
def products(survey_run):
    return measure(read_run(survey_run), ProductsCfg())


def test_the_page_tells_area_interval_and_what_it_means_and_loads_nothing(products, tmp_path):
    placement = EarthPlacement(products.recording.start, Datum(36.95, -122.02))
    page = write_products_page(products, placement, tmp_path, ["clusters.csv"]).read_text()
    assert f"{products.area.value:.2f} m²" in page
    assert f"{products.area.low:.2f} to {products.area.high:.2f} m²" in page
    assert "shells that overlap count once" in page
    assert "The recording has no colour pictures" in page
    assert "EPSG:32610" in page
    assert "clusters.csv" in page
    assert 'src="http' not in page
    assert "Compared with the truth" not in page


def test_the_truth_of_what_was_seen_has_a_section_of_its_own(products, survey_run, tmp_path):
    reef = load_world(survey_run / "world.yaml")
    seen = TruthComparison.of(products, reef)
    assert seen.inside
    assert 0.0 < seen.m2 <= seen.whole_m2
    nothing = replace(products, seen=np.zeros_like(products.seen))
    assert TruthComparison.of(nothing, reef).error is None
    truth = replace(seen, error=0.05)
    placement = EarthPlacement(products.recording.start)
    page = write_products_page(products, placement, tmp_path, [], truth).read_text()
    assert "The survey is +5.0 % off what it saw" in page
    assert f"{seen.whole_m2:.2f} m² of the whole reef" in page
    assert "no datum was given" in page


def test_the_page_says_that_a_network_found_the_oysters(products, tmp_path):
    recording = replace(products.recording, seen_by="painted")
    seen = replace(products, recording=recording, mosaic=replace(products.mosaic, colour=True))
    page = write_products_page(seen, EarthPlacement(recording.start), tmp_path, []).read_text()
    assert "Oysters were recognized by a network (painted)" in page
    assert "is <b>not</b> in the interval" in page
    calibrated = replace(seen, calibrated_reefs=15)
    page = write_products_page(calibrated, EarthPlacement(recording.start), tmp_path, []).read_text()
    assert "shells covered where it cast such votes on 15 generated reefs" in page
    assert "is <b>not</b> in the interval" not in page


def test_the_page_of_what_was_not_judged_has_no_cover(products, tmp_path):
    unlike = replace(products, judgement=Judgement(10, 9))
    page = write_products_page(unlike, EarthPlacement(products.recording.start), tmp_path, []).read_text()
    assert "<dt>cover where seen</dt><dd>not judged" in page


def test_colours_lie_between_the_stops():
    made = ramp(np.array([[0.0, 1.0, np.nan, 0.05]], np.float32), COVER_STOPS)
    assert made[0, 0].tolist() == [0xF4, 0xEF, 0xE3]
    assert made[0, 1].tolist() == [0x0B, 0x4A, 0x4F]
    assert made[0, 2].tolist() == list(UNSEEN)
    assert made[0, 3, 0] == (0xF4 + 0xCF) // 2
