import json

import numpy as np
import pytest

from coral.contact.real_scenes.bop_records import read_cameras
from coral.errors import InputError

TURN = [1, 0, 0, 0, 1, 0, 0, 0, 1]
CAMERA = {"cam_K": [500, 0, 320, 0, 510, 240, 0, 0, 1], "depth_scale": 0.1}


def put(tmp_path, content):
    path = tmp_path / "file.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


def test_the_camera_of_each_picture(tmp_path):
    placed = {"cam_R_w2c": [0, -1, 0, 1, 0, 0, 0, 0, 1], "cam_t_w2c": [0, 0, 1000]}
    found = read_cameras(put(tmp_path, {"0": CAMERA, "1": CAMERA | placed}))
    assert found[0].lens == pytest.approx([500, 510, 320, 240])
    assert found[0].depth_scale == 0.1
    assert np.array_equal(found[0].T_world_camera, np.eye(4))
    assert found[1].T_world_camera[:3, 3] == pytest.approx([0, 0, -1.0])
    assert found[1].T_world_camera[:3, 0] == pytest.approx([0, -1, 0])


@pytest.mark.parametrize(
    ("content", "named"),
    [
        ("{", "broken JSON"),
        ("[1]", "pictures"),
        ("[" * 100_000, "broken JSON"),
        ({"x": CAMERA}, "pictures.x"),
        ({"3": CAMERA | {"cam_R_w2c": TURN[:8], "cam_t_w2c": [0, 0, 0]}}, "0?.cam_R_w2c.*at least 9"),
        ({"3": CAMERA | {"cam_R_w2c": [2, *TURN[1:]], "cam_t_w2c": [0, 0, 0]}}, "a rotation matrix"),
        ({"3": CAMERA | {"cam_R_w2c": [-1, *TURN[1:]], "cam_t_w2c": [0, 0, 0]}}, "a rotation matrix"),
        ({"3": CAMERA | {"cam_R_w2c": TURN, "cam_t_w2c": [0, 0, None]}}, "cam_t_w2c"),
        ({"3": CAMERA | {"cam_R_w2c": TURN, "cam_t_w2c": [0, 0, 1e999]}}, "cam_t_w2c"),
    ],
)
def test_broken_files_are_named(content, named, tmp_path):
    with pytest.raises(InputError, match=named):
        read_cameras(put(tmp_path, content))


@pytest.mark.parametrize(
    "camera", [{}, CAMERA | {"cam_K": [1]}, CAMERA | {"cam_K": [0] * 9}, CAMERA | {"depth_scale": "x"}]
)
def test_broken_cameras_are_named(camera, tmp_path):
    with pytest.raises(InputError, match=r"file\.json"):
        read_cameras(put(tmp_path, {"0": camera}))
