"""`coral reef products`."""

import json
import shutil
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "reef"))

from survey_runs import write_run

pytest.importorskip("tifffile")
pytest.importorskip("pyproj")


@pytest.fixture(scope="module")
def survey_run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("survey") / "patch-001"
    write_run(folder)
    return folder


def test_products_of_a_run_are_written_beside_it_and_compared_with_the_truth(survey_run, told):
    code, result, _ = told("reef", "products", survey_run, "--datum", "36.95,-122.02", "--json")
    assert code == 0
    assert abs(result["area_error"]) < 0.1
    assert result["epsg"] == 32610
    assert (survey_run / "products/products.html").is_file()
    kept = json.loads((survey_run / "products/products.json").read_text())
    assert "true_area_m2" not in kept  # the truth never enters the products


@pytest.mark.slow
def test_a_survey_in_real_water_has_no_truth_and_lies_where_its_survey_file_says(survey_run, tmp_path, told):
    run = tmp_path / "run"
    shutil.copytree(survey_run, run, ignore=shutil.ignore_patterns("products"))
    start = "start: {x: 2, y: 2, theta: 0.5}\ndatum: [36.95, -122.02]\n"
    (run / "world.yaml").write_text(f"name: pier\nsize_m: [9, 8]\n{start}geofence: [[0, 0], [9, 0], [9, 8]]\n")
    for command in (("products", run), ("map", run)):
        code, result, _ = told("reef", *command, "--out", tmp_path / command[0], "--json")
        assert (code, result["epsg"]) == (0, 32610)
        assert "area_error" not in result


def test_it_is_told_in_a_few_lines(survey_run, tmp_path, told):
    code, out, _ = told("reef", "products", survey_run, "--out", tmp_path / "a")
    assert code == 0
    assert out.startswith("patch: oysters cover ")
    assert "in truth oysters cover" in out
    assert "60 oysters of 200 mm were in sight" in out
    assert "told apart from above" in out or "too few lie apart" in out
    assert "--datum LAT,LON gives the latitude" in out


def test_bad_input_is_one_line(survey_run, tmp_path, told):
    code, _, error = told("reef", "products", survey_run, "--datum", "north", "--out", tmp_path / "b")
    assert (code, error.count("\n")) == (2, 1)
    assert "LAT,LON" in error
    code, _, error = told("reef", "products", tmp_path)
    assert code == 2
    assert "the folder of a run" in error
    (tmp_path / "c").mkdir()
    (tmp_path / "c/mine.txt").write_text("mine")
    code, _, error = told("reef", "products", survey_run, "--out", tmp_path / "c")
    assert code == 2
    assert "a new or empty folder" in error


def test_a_planted_link_leads_to_no_other_folder(survey_run, tmp_path, told):
    run, private = tmp_path / "run", tmp_path / "private"
    shutil.copytree(survey_run, run, ignore=shutil.ignore_patterns("products"))
    private.mkdir()
    (run / "products").symlink_to(private)
    code, _, error = told("reef", "products", run)
    assert (code, error.count("\n")) == (2, 1)
    assert "products: found a link to another folder" in error
    assert not any(private.iterdir())
