import json

import numpy as np
import pytest

from coral.contact.real_scenes.bop_records import read_cameras, read_shared_camera, read_symmetry, read_truth
from coral.errors import InputError

TURN = [1, 0, 0, 0, 1, 0, 0, 0, 1]
POSE = {"cam_R_m2c": TURN, "cam_t_m2c": [100, 200, 900], "obj_id": 5}
CAMERA = {"cam_K": [500, 0, 320, 0, 510, 240, 0, 0, 1], "depth_scale": 0.1}


def put(tmp_path, content):
    path = tmp_path / "file.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


def test_lengths_become_metres(tmp_path):
    [placed] = read_truth(put(tmp_path, {"3": [POSE]}))[3]
    assert placed.number == 5
    assert placed.T_camera_object[:3, 3] == pytest.approx([0.1, 0.2, 0.9])


def test_a_rotation_that_is_slightly_off_becomes_the_nearest_one(tmp_path):
    [placed] = read_truth(put(tmp_path, {"3": [POSE | {"cam_R_m2c": [1.004, *TURN[1:]]}]}))[3]
    assert np.allclose(placed.T_camera_object[:3, :3], np.eye(3))


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


def test_declared_symmetries(tmp_path):
    half = [-1, 0, 0, 10, 0, -1, 0, 20, 0, 0, 1, 0, 0, 0, 0, 1]
    around = [{"axis": [0, 0, 2], "offset": [0, 0, 30]}]
    path = put(tmp_path, {"1": {}, "2": {"symmetries_discrete": [half]}, "3": {"symmetries_continuous": around}})
    middle = np.array([0.005, 0.01, 0.0])
    assert len(read_symmetry(path, 1, middle).members()) == 1
    two = read_symmetry(path, 2, middle)
    assert len(two.members()) == 2
    assert np.allclose(two.members()[1][:3, 3], [0.01, 0.02, 0])
    three = read_symmetry(path, 3, middle)
    assert np.allclose(three.axis, [0, 0, 1])
    assert np.allclose(three.center, [0, 0, 0.03])
    assert read_symmetry(path, 4, middle) is None


@pytest.mark.parametrize(
    ("content", "named"),
    [
        ("{", "broken JSON"),
        ("[1]", "list"),
        ("[" * 100_000, "broken JSON"),
        ({}, "no pose"),
        ({"3": []}, "no pose"),
        ({"x": [POSE]}, "index"),
        ({"3": POSE}, "list of poses"),
        ({"3": [7]}, "cam_R_m2c"),
        ({"3": [POSE | {"cam_R_m2c": TURN[:8]}]}, "9 finite numbers"),
        ({"3": [POSE | {"cam_R_m2c": [2, *TURN[1:]]}]}, "no rotation"),
        ({"3": [POSE | {"cam_R_m2c": [-1, *TURN[1:]]}]}, "no rotation"),
        ({"3": [POSE | {"cam_t_m2c": [0, 0, None]}]}, "cam_t_m2c"),
        ({"3": [POSE | {"cam_t_m2c": [0, 0, 1e999]}]}, "cam_t_m2c"),
        ({"3": [POSE | {"obj_id": "5"}]}, "obj_id"),
        ({"3": [POSE | {"obj_id": -1}]}, "obj_id"),
    ],
)
def test_broken_poses_are_named(content, named, tmp_path):
    with pytest.raises(InputError, match=named):
        read_truth(put(tmp_path, content))


@pytest.mark.parametrize(
    "camera", [{}, CAMERA | {"cam_K": [1]}, CAMERA | {"cam_K": [0] * 9}, CAMERA | {"depth_scale": "x"}]
)
def test_broken_cameras_are_named(camera, tmp_path):
    with pytest.raises(InputError, match=r"file\.json"):
        read_cameras(put(tmp_path, {"0": camera}))


@pytest.mark.parametrize("entry", [{"symmetries_discrete": [[1]]}, {"symmetries_continuous": [{"axis": [0, 0, 1]}]}, 7])
def test_broken_symmetries_are_named(entry, tmp_path):
    with pytest.raises(InputError, match="symmetr"):
        read_symmetry(put(tmp_path, {"1": entry}), 1, np.zeros(3))


def test_a_camera_of_another_model_is_named(tmp_path):
    model = {"cam_model": {"projection_model_type": "CameraModelType.FISHEYE624"}}
    with pytest.raises(InputError, match=r"0\.cam_model: found 'CameraModelType\.FISHEYE624', expected cam_K"):
        read_cameras(put(tmp_path, {"0": model}))


def test_files_of_one_camera_among_several_are_named(tmp_path):
    for name in ("scene_gt_cam1.json", "scene_gt_cam2.json"):
        (tmp_path / name).write_text("{}")
    with pytest.raises(InputError, match=r"found scene_gt_cam1\.json, scene_gt_cam2\.json instead, of one camera"):
        read_truth(tmp_path / "scene_gt.json")
