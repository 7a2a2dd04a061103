import json

import cv2
import numpy as np
import pytest
from drawn_board import FLAT, PLACED, picture

from coral.cli import main
from coral.commands import contact_calibrate
from coral.contact.real_scenes.calibration.camera_pose_file import read_camera_pose
from coral.contact.real_scenes.calibration.charuco_board import CharucoBoard
from coral.contact.scene.geometry import inverse_transform

BOARD = ["--board", "7x5:0.04:0.03"]


class OneCamera:
    """A camera of one picture."""

    live = False

    def __init__(self, frame):
        self.left = [frame]

    def start(self):
        pass

    def newest(self):
        return self.left.pop() if self.left else None

    def close(self):
        pass


def test_a_board_makes_a_file_for_camera_pose(monkeypatch, tmp_path, capsys):
    seen = picture(CharucoBoard(BOARD[1]), FLAT)
    monkeypatch.setattr(contact_calibrate, "make_camera_by_name", lambda word: OneCamera(seen))
    words = ["contact", "calibrate", "--camera", "mine", *BOARD, "--board-at", "0", "0.1", "0", "0", "--json"]
    assert main([*words, "--out", str(tmp_path / "camera.yaml")]) == 0
    assert json.loads(capsys.readouterr().out)["residuals"]["rms_px"] < 1.0
    found = read_camera_pose(tmp_path / "camera.yaml")
    assert inverse_transform(found) @ PLACED == pytest.approx(np.eye(4), abs=5e-3)
    assert main([*words, "--out", str(tmp_path / "camera.yaml")]) == 2  # not overwritten


def test_a_picture_without_a_board_is_one_line(tmp_path, capsys):
    words = ["contact", "calibrate", "--camera", "drawn:pick-box", *BOARD, "--board-at", "0", "0", "0", "0"]
    assert main([*words, "--out", str(tmp_path / "c.yaml")]) == 2
    assert "found no board in 10 pictures" in capsys.readouterr().err
    assert not (tmp_path / "c.yaml").exists()


def test_a_board_is_drawn_for_the_printer(tmp_path, capsys):
    assert main(["contact", "calibrate", *BOARD, "--draw", str(tmp_path / "b.png")]) == 0
    assert "0.28 x 0.2 m" in capsys.readouterr().out
    assert cv2.imread(str(tmp_path / "b.png")).shape[:2] == (1000, 1400)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "--board"),
        (BOARD, "--board-at"),
        ([*BOARD, "--board-at", "0", "0", "0", "0"], "--camera"),
        (["--draw", "b.png"], "--board"),
    ],
)
def test_flags_that_do_not_go_together_are_one_line(words, told, capsys):
    assert main(["contact", "calibrate", *words]) == 2
    assert told in capsys.readouterr().err
