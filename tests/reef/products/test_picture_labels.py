"""Outlines and points for people to correct."""

import csv
import json
from dataclasses import replace

import cv2
import numpy as np
import pytest
from survey_runs import write_run

from coral.reef.products.picture_labels import LabelsCfg, find_outlines, write_labels
from coral.reef.recordings.run_recording import read_run
from coral.reef.world.geometry import Label


@pytest.fixture(scope="module")
def located(tmp_path_factory):
    folder = tmp_path_factory.mktemp("survey") / "patch-001"
    write_run(folder, colour=True)
    return read_run(folder).located()


def test_outlines_come_back_as_the_pixels_that_they_are_of(located, tmp_path):
    files = write_labels(located, 41, LabelsCfg(pictures=10), tmp_path / "labels")
    content = json.loads((tmp_path / "labels/coco.json").read_text())
    assert len(content["images"]) == 9
    assert content["categories"] == [{"id": 1, "name": "oyster"}]
    assert sorted(files) == sorted(path.name for path in (tmp_path / "labels").iterdir())
    frames = {f"patch_{k:06d}.jpg": one.frame for k, one in enumerate(located.keyframes())}
    covered = np.zeros(3)
    for image in content["images"]:
        assert (tmp_path / "labels" / image["file_name"]).is_file()
        mask = np.zeros((image["height"], image["width"]), np.uint8)
        for one in content["annotations"]:
            if one["image_id"] == image["id"]:
                cv2.fillPoly(mask, [np.array(one["segmentation"][0], np.int32).reshape(-1, 2)], 1)
        true = frames[image["file_name"]].labels == Label.OYSTER
        covered += np.array([((mask > 0) & true).sum(), true.sum(), (mask > 0).sum()])
    assert covered[0] >= 0.95 * covered[1]  # patches of few pixels are left out
    assert covered[0] >= 0.8 * covered[2]  # gaps within an outline are filled


def test_points_are_those_of_coralnet_and_lie_where_the_map_has_them(located, tmp_path):
    write_labels(located, 41, LabelsCfg(pictures=41, points=30), tmp_path / "labels")
    rows = list(csv.DictReader((tmp_path / "labels/coralnet.csv").open()))
    assert list(rows[0]) == ["Name", "Row", "Column", "Label"]
    frames = {f"patch_{k:06d}.jpg": one.frame for k, one in enumerate(located.keyframes())}
    for row in rows:
        assert Label[row["Label"].upper()] == frames[row["Name"]].labels[int(row["Row"]), int(row["Column"])]
    oysters = [row for row in csv.DictReader((tmp_path / "labels/points.csv").open()) if row["Label"] == "oyster"]
    assert len(oysters) > 10
    places = np.array([[float(row["x_m"]), float(row["y_m"])] for row in oysters])
    assert np.hypot(*(places - (5.0, 4.0)).T).max() < 2.0


def test_small_patches_are_left_out_and_without_colours_there_is_nothing(located, tmp_path):
    labels = np.zeros((20, 20), np.uint8)
    labels[2:4, 2:4] = labels[10:15, 10:15] = Label.OYSTER
    assert [one["bbox"] for one in find_outlines(labels)] == [[10, 10, 5, 5]]
    gray = replace(
        located, keyframes=lambda: (replace(k, frame=replace(k.frame, rgb=None)) for k in located.keyframes())
    )
    assert write_labels(gray, 41, LabelsCfg(), tmp_path / "a") == []
    assert write_labels(located, 41, LabelsCfg(pictures=0), tmp_path / "a") == []
    assert not (tmp_path / "a").exists()
