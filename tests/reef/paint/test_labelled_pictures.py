"""Labels of real pictures: every form gives the same target."""

import json

import cv2
import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.paint.collage import OTHER
from coral.reef.paint.labelled_pictures import UNKNOWN, read_labelled, video_of
from coral.reef.world.geometry import Label

OYSTER = int(Label.OYSTER)


def picture(folder, name="reef-0001.png"):
    folder.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(folder / name), np.full((40, 80, 3), 90, np.uint8))


def only(folder, oysters=()):
    (one,) = read_labelled(folder, oysters)
    return one


def half(target):
    """Check that the left half is oyster and the rest is not."""
    return (target[1:39, 1:39] == OYSTER).all() and (target[:, 42:] == OTHER).all()


def test_an_outline_in_fractions_is_filled(tmp_path):
    picture(tmp_path)
    (tmp_path / "reef-0001.txt").write_text("2 0 0 0.5 0 0.5 1 0 1\n\n")
    one = only(tmp_path)
    assert (one.video, half(one.target)) == ("reef", True)
    assert (only(tmp_path, ("1",)).target == OTHER).all()


def test_a_box_is_oyster_in_its_ellipse_and_unknown_in_its_corners(tmp_path):
    picture(tmp_path)
    (tmp_path / "reef-0001.txt").write_text("0 0.25 0.5 0.5 1.0\n")
    target = only(tmp_path).target
    assert (target[20, 20], target[1, 1], target[20, 60]) == (OYSTER, UNKNOWN, OTHER)


def test_an_export_of_roboflow_has_parts_and_names(tmp_path):
    for part in ("train", "valid"):
        picture(tmp_path / part / "images", f"{part}-0001_jpg.rf.abc123.png")
        (tmp_path / part / "labels").mkdir()
        label = tmp_path / part / "labels" / f"{part}-0001_jpg.rf.abc123.txt"
        label.write_text("0 0 0 0.5 0 0.5 1 0 1\n1 0.6 0 1 0 1 1 0.6 1\n")
    (tmp_path / "data.yaml").write_text("names: [Oyster, Drill]\n")
    found = list(read_labelled(tmp_path, ("Oyster",)))
    assert [one.video for one in found] == ["train", "valid"]
    assert all(half(one.target) for one in found)


def test_coco_outlines_and_boxes(tmp_path):
    picture(tmp_path)
    marks = [
        {"image_id": 7, "category_id": 1, "segmentation": [[0, 0, 40, 0, 40, 40, 0, 40]], "bbox": [0, 0, 40, 40]},
        {"image_id": 7, "category_id": 2, "bbox": [50, 0, 20, 40]},
    ]
    names = [{"id": 1, "name": "oyster"}, {"id": 2, "name": "crab"}]
    images = [{"id": 7, "file_name": "reef-0001.png"}]
    file = tmp_path / "annotations.json"
    file.write_text(json.dumps({"images": images, "categories": names, "annotations": marks}))
    assert half(only(tmp_path, ("oyster",)).target)
    images[0]["file_name"] = "../reef-0001.png"
    file.write_text(json.dumps({"images": images, "categories": names, "annotations": marks}))
    with pytest.raises(InputError, match="leads out"):
        only(tmp_path)


def test_a_mask_beside_the_picture(tmp_path):
    picture(tmp_path)
    mask = np.zeros((40, 80), np.uint8)
    mask[:, :40] = 255
    cv2.imwrite(str(tmp_path / "reef-0001_mask.png"), mask)
    assert half(only(tmp_path).target)


def test_points_leave_the_rest_unknown(tmp_path):
    picture(tmp_path)
    (tmp_path / "annotations.csv").write_text(
        "Name,Row,Column,Label\nreef-0001.png,20,20,Oyster\nreef-0001.png,20,60,Sand\n"
    )
    target = only(tmp_path).target
    assert (target[20, 20], target[20, 60], target[2, 2]) == (OYSTER, OTHER, UNKNOWN)


@pytest.mark.parametrize("text", ["0 0.1", "x 0 0 1 1", "0 0 0 nan 1", "0.5 0 0 1 1 1 0"])
def test_a_broken_line_is_named(tmp_path, text):
    picture(tmp_path)
    (tmp_path / "reef-0001.txt").write_text(f"0 0 0 1 0 1 1\n{text}\n")
    with pytest.raises(InputError, match="line 2"):
        only(tmp_path)


def test_a_folder_without_labels_is_refused(tmp_path):
    picture(tmp_path)
    with pytest.raises(InputError, match="no labelled picture"):
        list(read_labelled(tmp_path))


@pytest.mark.parametrize(
    ("name", "video"),
    [
        ("GOPR1077_MP4-0012_jpg", "GOPR1077_MP4"),
        ("Usable1_MP4-3_jpg", "Usable1_MP4"),
        ("Usable1_MP4-3_jpg.rf.0ab1", "Usable1_MP4"),
        ("View-1-_151_jpg", "View-1"),
        ("0001", "0001"),
    ],
)
def test_frames_of_a_video_share_a_name(name, video):
    assert video_of(name) == video
