"""`coral reef picture`: one picture, a sheet of waters, and refusals before anything is drawn."""

import cv2
import numpy as np
import pytest


def test_one_picture_is_taken_from_a_place(told, tmp_path):
    out = tmp_path / "picture.png"
    code, result, _ = told(
        "reef",
        "picture",
        "s1",
        "--at",
        "6",
        "5.3",
        "90",
        "--size",
        "64",
        "48",
        "--water",
        "bay",
        "--out",
        out,
        "--json",
    )
    assert code == 0
    assert result == {"picture": str(out), "waters": {"jerlov-3C": 4.27}, "at": [6.0, 5.3, 90.0]}
    assert cv2.imread(str(out)).shape == (48, 64, 3)


def test_several_waters_make_a_sheet(told, tmp_path):
    out = tmp_path / "sheet.png"
    code, text, _ = told("reef", "picture", "s1", "--size", "64", "48", "--water", "clear", "hard", "--out", out)
    assert code == 0
    assert "jerlov-IB" in text
    assert "jerlov-5C" in text
    height, width, _ = cv2.imread(str(out)).shape
    assert width > 2 * 64
    assert height < 2 * 48


@pytest.mark.parametrize(
    ("flags", "named"),
    [
        (["--out", "a.jpg"], "ends in .png"),
        (["--out", "a.png", "--water", "tap"], "--water"),
        (["--out", "a.png", "--at", "nan", "0", "0"], "--at"),
        (["--out", "a.png", "--seed", "-1"], "--seed"),
        (["--out", "a.png", "--painter.water-depth-m", "-1"], "water_depth_m"),
    ],
)
def test_bad_flags_are_named(told, tmp_path, monkeypatch, flags, named):
    monkeypatch.chdir(tmp_path)
    code, _, error = told("reef", "picture", "s1", *flags)
    assert code == 2
    assert named in error
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_overwritten(told, tmp_path):
    out = tmp_path / "mine.png"
    out.write_bytes(b"mine")
    code, _, error = told("reef", "picture", "s1", "--out", out)
    assert code == 2
    assert "exists" in error
    assert out.read_bytes() == b"mine"


def test_pictures_of_one_folder_are_a_recording_that_map_reads(told, tmp_path):
    pytest.importorskip("onnxruntime")
    folder = tmp_path / "dive"
    for k, x in enumerate(("6", "6.3")):
        words = ("--at", x, "5.3", "90", "--size", "64", "48", "--out", folder / f"{k}.png")
        assert told("reef", "picture", "s1", *words)[0] == 0
    assert (folder / "poses.csv").read_text().splitlines() == [
        "t,x,y,z,roll,pitch,yaw,rgb", "0,6,5.3,1,0,0,1.57079633,0.png", "1,6.3,5.3,1,0,0,1.57079633,1.png",
    ]  # fmt: skip
    code, made, error = told("reef", "map", folder, "--perception", "painted", "--out", tmp_path / "map", "--json")
    assert code == 0, error
    assert made["keyframes"] == 2
    code, _, error = told("reef", "picture", "s1", "--size", "32", "24", "--out", folder / "2.png")
    assert (code, error.count("\n")) == (2, 1)
    assert "camera.yaml: found another camera" in error
    assert not (folder / "2.png").exists()


def test_an_animal_is_elsewhere_at_another_time(told, tmp_path):
    reddest = []
    for t in ("0", "12"):
        out = tmp_path / f"{t}.png"
        told("reef", "picture", "kind:crab", "--at", "10", "7.5", "90", "--t", t, "--out", out, "--size", "160", "120")
        blue, green, red = np.moveaxis(cv2.imread(str(out)).astype(int), -1, 0)
        reddest.append(np.unravel_index(np.argmax(2 * red - green - blue), red.shape))
    assert np.hypot(*np.subtract(*reddest)) > 5
