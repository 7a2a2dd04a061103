import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from coral.calibration_board import CharucoBoard
from coral.cli import main
from coral.reef.sea.recorded_camera import read_camera
from coral.view.mp4 import write_mp4
from reef.sea.rendered_boards import PLAIN, picture, poses

BOARD = "9x6:0.03:0.022"


def calibrate(*words):
    return main(["camera", "calibrate", *map(str, words)])


@pytest.fixture(scope="module")
def pool(tmp_path_factory):
    """A folder of pictures of a ChArUco board."""
    folder = tmp_path_factory.mktemp("pool")
    flat = CharucoBoard(BOARD).draw(60)
    for k, (turn, shift) in enumerate(poses(PLAIN, 12)):
        rgb = picture(PLAIN, flat, 2000.0, turn, shift)
        cv2.imwrite(str(folder / f"{k:02d}.png"), rgb)
    return folder


def test_a_folder_of_pictures_makes_a_file_for_the_camera(pool, tmp_path, capsys):
    out = tmp_path / "new" / "camera.yaml"
    words = (pool, "--board", BOARD, "--model", "plumb_bob", "--pitch-down-deg", "20", "--out", out)
    assert calibrate(*words, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["looked_at"], found["found"], found["model"]) == (12, 12, "plumb_bob")
    assert (found["fx"], found["fy"]) == pytest.approx((PLAIN.fx, PLAIN.fy), rel=0.01)
    camera = read_camera(out)
    assert camera.size == (640, 480)
    assert camera.view.pitch_down_deg == 20.0
    assert calibrate(*words) == 2  # not overwritten
    assert "a new file" in capsys.readouterr().err


def test_a_link_to_nowhere_is_not_written_through(pool, tmp_path, capsys):
    (tmp_path / "camera.yaml").symlink_to(tmp_path / "elsewhere.yaml")
    assert calibrate(pool, "--board", BOARD, "--out", tmp_path / "camera.yaml") == 2
    assert not (tmp_path / "elsewhere.yaml").exists()


def test_a_video_without_enough_boards_says_how_many(pool, tmp_path, capsys):
    board = cv2.imread(str(pool / "05.png"))
    write_mp4(tmp_path / "pool.mp4", [board if k < 5 else np.zeros_like(board) for k in range(20)], (640, 480), 10.0)
    assert calibrate(tmp_path / "pool.mp4", "--board", BOARD, "--out", tmp_path / "camera.yaml") == 2
    said = capsys.readouterr().err
    assert "pool.mp4: found the board 9x6:0.03:0.022 in 5 of 20 pictures, expected 8 pictures that show it" in said
    assert len(said.splitlines()) == 1
    assert not (tmp_path / "camera.yaml").exists()


def test_pictures_that_fit_badly_at_the_edges_are_told():
    from coral.commands.camera_calibrate import CameraCalibrate

    result = {
        "out": "camera.yaml", "model": "plumb_bob", "fx": 1.0, "fy": 1.0, "cx": 1.0, "cy": 1.0, "rms_px": 0.2,
        "left_out_px": {"plumb_bob": 0.2, "equidistant": None}, "looked_at": 60, "found": 20, "used": 19,
        "reached": 0.5, "edges_reached": 0.1,
    }  # fmt: skip
    told = CameraCalibrate(pictures=Path("pool"), board=BOARD).describe(result)
    assert "plumb_bob 0.20 px, equidistant none" in told
    assert "! the edges were hardly reached" in told


def spoil_size(folder):
    cv2.imwrite(str(folder / "a.png"), np.zeros((48, 64, 3), np.uint8))
    cv2.imwrite(str(folder / "b.png"), np.zeros((40, 64, 3), np.uint8))
    return folder


def text(name):
    def write(folder):
        (folder / name).write_text("no picture")
        return folder if name.endswith("png") else folder / name

    return write


@pytest.mark.parametrize(
    ("make", "words", "told"),
    [
        (spoil_size, (), "b.png: found 64 x 40 pixels, expected 64 x 48, the size of the first picture"),
        (text("notes.txt"), (), "notes.txt: found neither, expected a folder of pictures, or a video"),
        (text("notes.png"), (), "notes.png: rgb: found no picture"),
        (text("notes.mp4"), (), "notes.mp4: found no pictures, expected a whole video"),
        (lambda folder: folder, (), "found no pictures"),
        (lambda folder: folder / "nothing.mp4", (), "no such file"),
        (lambda folder: folder, ("--board", "9x6"), "--board: found '9x6'"),
        (lambda folder: folder, ("--pitch-down-deg", "100"), "between -90 and 90"),
        (lambda folder: folder, ("--pitch-down-deg", "nan"), "pitch"),
    ],
)
def test_what_cannot_be_used_is_one_line(make, words, told, tmp_path, capsys):
    given = (make(tmp_path), *(() if "--board" in words else ("--board", "9x6:0.03")), *words)
    assert calibrate(*given, "--out", tmp_path / "camera.yaml") == 2
    said = capsys.readouterr().err
    assert told in said
    assert len(said.splitlines()) == 1
