import json

import numpy as np
import pytest

from coral.contact.real_scenes.bop_records import read_cameras, read_shared_camera
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
    assert found[0].depth_scale_mm == 0.1
    assert np.array_equal(found[0].T_world_camera, np.eye(4))
    assert found[1].T_world_camera[:3, 3] == pytest.approx([0, 0, -1.0])
    assert found[1].T_world_camera[:3, 0] == pytest.approx([0, -1, 0])


def test_one_camera_for_all(tmp_path):
    found = read_shared_camera(put(tmp_path, {"fx": 5, "fy": 6, "cx": 7, "cy": 8, "depth_scale": 1.0, "width": 640}))
    assert found.lens == pytest.approx([5, 6, 7, 8])


@pytest.mark.parametrize(
    ("content", "named"),
    [
        ("{", "broken JSON"),
        ("[1]", "list"),
        ("[" * 100_000, "broken JSON"),
        ({"x": CAMERA}, "index"),
        ({"3": CAMERA | {"cam_R_w2c": TURN[:8], "cam_t_w2c": [0, 0, 0]}}, "9 finite numbers"),
        ({"3": CAMERA | {"cam_R_w2c": [2, *TURN[1:]], "cam_t_w2c": [0, 0, 0]}}, "no rotation"),
        ({"3": CAMERA | {"cam_R_w2c": [-1, *TURN[1:]], "cam_t_w2c": [0, 0, 0]}}, "no rotation"),
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


def test_a_camera_of_another_model_is_named(tmp_path):
    model = {"cam_model": {"projection_model_type": "CameraModelType.FISHEYE624"}}
    with pytest.raises(InputError, match=r"0\.cam_model: found 'CameraModelType\.FISHEYE624', expected cam_K"):
        read_cameras(put(tmp_path, {"0": model}))


def test_files_of_one_camera_among_several_are_named(tmp_path):
    for name in ("scene_camera_cam1.json", "scene_camera_cam2.json"):
        (tmp_path / name).write_text("{}")
    with pytest.raises(InputError, match=r"found scene_camera_cam1\.json, scene_camera_cam2\.json instead"):
        read_cameras(tmp_path / "scene_camera.json")
