"""`coral reef map`: recordings of every kind become the same map."""

import csv
import json
import shutil
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "reef"))

from autopilot_logs import dataflash_dive
from survey_runs import write_run

from onnx_files import red_is_oyster

pytest.importorskip("tifffile")
pytest.importorskip("rosbags")


@pytest.fixture(scope="module")
def survey_run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("survey") / "patch-001"
    write_run(folder, drift=0.02)
    return folder


@pytest.mark.slow
def test_a_run_its_mcap_file_and_its_bag_give_the_same_oysters(survey_run, tmp_path, told):
    assert told("export", survey_run, "--to", "mcap", "--out", tmp_path / "x.mcap")[0] == 0
    assert told("export", survey_run, "--to", "bag", "--out", tmp_path / "x_bag")[0] == 0
    made = []
    for k, recording in enumerate((survey_run, tmp_path / "x.mcap", tmp_path / "x_bag")):
        code, result, error = told("reef", "map", recording, "--out", tmp_path / str(k), "--json")
        assert code == 0, error
        made.append((result["oyster_cells"], result["oyster_area_m2"], (tmp_path / str(k) / "cells.png").read_bytes()))
    assert made[0] == made[1] == made[2]
    assert made[0][0] > 200


def test_products_of_a_run_are_written_beside_it_and_compared_with_the_truth(survey_run, told):
    code, result, _ = told("reef", "map", survey_run, "--datum", "36.95,-122.02", "--json")
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
    code, result, _ = told("reef", "map", run, "--json")
    assert (code, result["epsg"]) == (0, 32610)
    assert "area_error" not in result


def test_it_is_told_in_a_few_lines(survey_run, tmp_path, told):
    code, out, _ = told("reef", "map", survey_run, "--out", tmp_path / "a")
    assert code == 0
    assert out.startswith("patch: oysters cover ")
    assert "in truth oysters cover" in out
    assert "60 oysters of 200 mm were in sight" in out
    assert "told apart from above" in out or "too few lie apart" in out
    assert "--datum LAT,LON gives the latitude" in out


def test_bad_flags_are_one_line(survey_run, tmp_path, told):
    (tmp_path / "c").mkdir()
    (tmp_path / "c/mine.txt").write_text("mine")
    for words, said in (
        (("--datum", "north", "--out", tmp_path / "b"), "LAT,LON"), (("--out", tmp_path / "c"), "a new or empty folder")
    ):  # fmt: skip
        code, _, error = told("reef", "map", survey_run, *words)
        assert (code, error.count("\n"), said in error) == (2, 1, True)


def test_a_planted_link_leads_to_no_other_folder(survey_run, tmp_path, told):
    run, private = tmp_path / "run", tmp_path / "private"
    shutil.copytree(survey_run, run, ignore=shutil.ignore_patterns("products"))
    private.mkdir()
    (run / "products").symlink_to(private)
    code, _, error = told("reef", "map", run)
    assert (code, error.count("\n")) == (2, 1)
    assert "products: found a link to another folder" in error
    assert not any(private.iterdir())


def test_what_is_no_recording_is_one_line(tmp_path, told):
    (tmp_path / "text.mcap").write_text("no")
    for path in (tmp_path / "text.mcap", tmp_path, tmp_path / "gone"):
        code, _, error = told("reef", "map", path, "--out", tmp_path / "o")
        assert (code, error.count("\n")) == (2, 1)


@pytest.mark.slow
def test_pictures_with_an_autopilots_log(network, tmp_path, told):
    (tmp_path / "dive.BIN").write_bytes(dataflash_dive())
    (tmp_path / "camera.yaml").write_text("{width: 80, height: 60, altitude_m: 1.0}\n")
    rows = [f"{0.5 * k},{k}.png\n" for k in range(8)]
    (tmp_path / "times.csv").write_text("t,rgb\n" + "".join(rows))
    for k in range(8):
        cv2.imwrite(str(tmp_path / f"{k}.png"), np.full((60, 80, 3), (0, 0, 255), np.uint8))
    words = "reef", "map", tmp_path, "--perception", network, "--out", tmp_path / "o"
    code, result, error = told(*words, "--pictures-start-s", "100.5", "--datum", "54.3,10.1", "--json")
    assert code == 0, error
    assert (result["keyframes"], result["pictures_left_out"]) == (8, 0)
    assert result["eyes"][0].startswith("dive.BIN: first picture at 100.5 s of the log's clock, 0.5 s after")
    for start, said in (("nan", "a number of seconds"), ("noon", "noon"), ("300", "pictures (times.csv) from 300.0")):
        code, _, error = told(*words[:-1], tmp_path / "p", "--pictures-start-s", start)
        assert (code, error.count("\n"), said in error) == (2, 1, True), error


@pytest.fixture(scope="module")
def colour_run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("survey") / "patch-001"
    write_run(folder, colour=True)
    return folder


@pytest.fixture(scope="module")
def network(tmp_path_factory):
    """A file with a network that takes red for oysters and everything else for sea floor: `coral.reef.networks`."""
    path = tmp_path_factory.mktemp("net") / "red.onnx"
    path.write_bytes(red_is_oyster(80, 60))
    return path


def cluster(folder):
    """Place (m north and east of the equator's origin) and area of the only cluster of some products."""
    (row,) = csv.DictReader((folder / "clusters.csv").open())
    return [111_320.0 * float(row[name]) for name in ("latitude", "longitude")], float(row["area_m2"])


@pytest.mark.slow
def test_pictures_and_poses_alone_become_a_map_with_the_oysters_where_they_are(colour_run, network, tmp_path, told):
    place = ("--datum", "0.001,0.001")
    assert told("reef", "map", colour_run, *place, "--out", tmp_path / "exact")[0] == 0
    there, area = cluster(tmp_path / "exact")
    for kind, name in (("mcap", "x.mcap"), ("pictures", "x")):
        assert told("export", colour_run, "--to", kind, "--out", tmp_path / name)[0] == 0
        code, made, error = told(
            "reef", "map", tmp_path / name, "--perception", network, *place, "--out", tmp_path / f"map-{kind}", "--json"
        )
        assert code == 0, error
        assert made["perception"] == str(network)
        found, seen = cluster(tmp_path / f"map-{kind}")
        assert found == pytest.approx(there, abs=0.2)
        # Without true depth, shells lean away from the camera, and blurred edges are no oysters: not quite the same.
        assert 0.6 * area < seen < 1.7 * area


def test_a_run_seen_by_a_network_is_compared_with_the_truth(colour_run, network, tmp_path, told):
    code, out, _ = told("reef", "map", colour_run, "--perception", network, "--out", tmp_path / "m")
    assert code == 0
    assert "its errors are not in the interval" in out
    assert "classes: 0 water: water; 1 oyster: oyster; 2 obstacle: obstacle; 3 seabed: seabed" in out
    assert "in truth oysters cover" in out
    assert "Oysters were recognized by a network" in (tmp_path / "m/products.html").read_text()


@pytest.mark.slow
def test_doubtful_oysters_do_not_count(colour_run, network, tmp_path, told):
    code, made, _ = told(
        "reef", "map", colour_run, "--perception", network, "--doubt.oyster", "0", "--out", tmp_path / "m", "--json"
    )
    assert code == 0
    assert made["oyster_cells"] == 0


def test_eyes_of_another_package_map_a_recording(colour_run, tmp_path, told, monkeypatch):
    asked = []

    def opened(name, **how):
        asked.append(name)

    monkeypatch.setattr(
        "coral.commands.reef_map.has_plugin", lambda group, name: (group, name) == ("coral.eyes", "mine")
    )
    monkeypatch.setattr("coral.commands.reef_map.open_eyes", opened)
    assert told("reef", "map", colour_run, "--perception", "mine", "--out", tmp_path / "m")[0] == 0
    assert asked == ["mine"]


@pytest.mark.slow
def test_a_lens_that_disagrees_leads_and_a_turned_picture_is_told(colour_run, network, tmp_path, told, monkeypatch):
    assert told("export", colour_run, "--to", "pictures", "--out", tmp_path / "x")[0] == 0
    picture = tmp_path / "x/000003.jpg"
    exif = b"Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x03\0\0\0\0\0\0\0"  # 3: turned by 180 degrees
    plain = picture.read_bytes()
    picture.write_bytes(plain[:2] + b"\xff\xe1" + (len(exif) + 2).to_bytes(2, "big") + exif + plain[2:])
    monkeypatch.setattr("coral.commands.reef_map.check_lens", lambda recording: "the lens disagrees with the pictures")
    code, out, _ = told("reef", "map", tmp_path / "x", "--perception", network, "--out", tmp_path / "m")
    assert code == 0
    assert out.startswith("the lens disagrees with the pictures\n")
    assert "000003.jpg has EXIF orientation 3: pixels are used as they lie in the file" in out
    assert "The lens disagrees with the pictures." in (tmp_path / "m/products.html").read_text()
    assert json.loads((tmp_path / "m/products.json").read_text())["lens"] == "the lens disagrees with the pictures"


def test_recordings_that_lie_are_one_line(colour_run, network, tmp_path, told):
    assert told("export", colour_run, "--to", "pictures", "--out", tmp_path / "x")[0] == 0
    table, picture = tmp_path / "x/poses.csv", tmp_path / "x/000003.jpg"
    text, content = table.read_text(), picture.read_bytes()

    def refused(*words):
        code, _, error = told("reef", "map", tmp_path / "x", "--out", tmp_path / "o", *words)
        assert (code, error.count("\n")) == (2, 1), error
        assert not (tmp_path / "o").exists()
        return error

    assert "--perception rgb" in refused()
    assert "--out: found nothing" in told("reef", "map", tmp_path / "x", "--perception", network)[2]
    assert "recorded, rgb, painted or FILE.onnx (did you mean 'rgb'?)" in refused("--perception", "rbg")
    assert "--period-s" in refused("--period-s", "-1", "--perception", network)
    picture.unlink()
    assert "line 4: rgb: found 000003.jpg: no such file" in refused("--perception", network)
    picture.write_bytes(content[:200])
    assert "line 4: rgb: found no picture" in refused("--perception", network)
    picture.write_bytes(content)
    table.write_text(text.replace("\n1,", "\n9,"))
    assert "expected times that never go back" in refused("--perception", network)
    table.write_text(text.replace("\n1,", "\n1,nan").replace("nan2", "nan,2"))
    assert "expected" in refused("--perception", network)
    table.write_text(text)
    (tmp_path / "x/camera.yaml").write_text("{width: 800, height: 600}")
    assert "line 2: rgb: found 80 x 60 pixels, expected 800 x 600" in refused("--perception", network)
