import json

import cv2
import numpy as np
import pytest
import yaml
from recorded_scenes import write_frames

from coral.cli import main
from coral.contact.perception.camera import RgbdFrame, look_at
from coral.contact.real_scenes.calibration.camera_pose_file import read_camera_pose
from coral.contact.scene.rigid_transform import inverse_transform

LENS = np.array([300.0, 300.0, 159.5, 119.5])
PLACED = look_at((-0.3, -0.6, 0.5), (0.05, 0.0, 0.0))


@pytest.fixture
def table(tmp_path):
    """A recording of an empty table, and pixels with the points that they show."""
    u, v = np.meshgrid(np.arange(320), np.arange(240))
    rays = np.stack([(u - LENS[2]) / LENS[0], (v - LENS[3]) / LENS[1], np.ones(u.shape)], axis=2)
    depth = (-PLACED[2, 3] / (rays @ PLACED[2, :3])).clip(0, 3).astype(np.float32)
    rgb = np.full((240, 320, 3), 180, np.uint8)
    frame = RgbdFrame(depth, np.zeros(depth.shape, np.uint8), (), LENS, np.eye(4), 0.0, rgb)
    write_frames(tmp_path / "table", [frame])
    pixels = [(100, 140), (220, 150), (110, 220), (230, 230)]
    seen = [rays[row, column] * depth[row, column] for column, row in pixels]
    touched = [(PLACED @ [*point, 1.0])[:3].tolist() for point in seen]
    touches = [{"pixel": [*p], "touched_m": t} for p, t in zip(pixels, touched, strict=True)]
    (tmp_path / "touches.yaml").write_text(yaml.safe_dump({"touches": touches}))
    return f"recording:{tmp_path / 'table'}"


def test_touched_points_make_a_file_for_camera_pose(table, tmp_path, capsys):
    words = ["contact", "calibrate", "--camera", table, "--touches", str(tmp_path / "touches.yaml"), "--json"]
    assert main([*words, "--out", str(tmp_path / "camera.yaml")]) == 0
    assert json.loads(capsys.readouterr().out)["residuals"]["rms_mm"] < 1.0
    found = read_camera_pose(tmp_path / "camera.yaml")
    assert inverse_transform(found) @ PLACED == pytest.approx(np.eye(4), abs=2e-3)
    assert main([*words, "--out", str(tmp_path / "camera.yaml")]) == 2  # not overwritten


def test_a_picture_without_a_board_is_one_line(table, tmp_path, capsys):
    words = ["contact", "calibrate", "--camera", table, "--board", "7x5:0.04:0.03", "--board-at", "0", "0", "0", "0"]
    assert main([*words, "--out", str(tmp_path / "c.yaml")]) == 2
    assert "found no board in 1 pictures" in capsys.readouterr().err
    assert not (tmp_path / "c.yaml").exists()


def test_a_board_is_drawn_for_the_printer(tmp_path, capsys):
    assert main(["contact", "calibrate", "--board", "7x5:0.04:0.03", "--draw", str(tmp_path / "b.png")]) == 0
    assert "0.28 x 0.2 m" in capsys.readouterr().out
    assert cv2.imread(str(tmp_path / "b.png")).shape[:2] == (1000, 1400)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "--touches"),
        (["--board", "7x5:0.04:0.03"], "--board-at"),
        (["--touches", "t.yaml"], "--camera"),
        (["--touches", "t.yaml", "--board", "7x5:0.04:0.03"], "--touches: found both"),
        (["--draw", "b.png"], "--board"),
    ],
)
def test_flags_that_do_not_go_together_are_one_line(words, told, capsys):
    assert main(["contact", "calibrate", *words]) == 2
    assert told in capsys.readouterr().err
