import json

import cv2
import numpy as np
import pytest
from recorded_scenes import write_scene

from coral.contact.real_scenes.bop_scene import MOST_TRIANGLES, BopScene
from coral.errors import InputError


@pytest.fixture
def folder(trial, tmp_path):
    write_scene(tmp_path / "scene", trial)
    return tmp_path / "scene"


def test_models_are_found_above_the_scene(folder):
    (folder / "models").rename(folder.parent / "models_eval")
    assert BopScene(folder).triangles(1).shape[1:] == (3, 3)


def test_models_can_be_elsewhere(folder, tmp_path):
    (folder / "models").rename(tmp_path / "elsewhere")
    with pytest.raises(InputError, match="--models"):
        BopScene(folder)
    assert BopScene(folder, tmp_path / "elsewhere").model(2).diameter > 0.05


def test_one_camera_serves_all_pictures_where_there_is_none_for_each(folder):
    (folder / "scene_camera.json").unlink()
    (folder.parent / "camera.json").write_text(json.dumps({"fx": 60, "fy": 60, "cx": 32, "cy": 24, "depth_scale": 0.1}))
    assert BopScene(folder).read_frame(1).lens == pytest.approx([60, 60, 32, 24])


def test_a_model_with_many_triangles_is_reduced(folder):
    scene = BopScene(folder)
    many = np.repeat(scene.triangles(1), 400, axis=0) + np.random.default_rng(0).normal(0, 0.001, (1, 1, 3))
    scene.triangles = lambda number: many
    assert len(scene.model(1).triangles) <= MOST_TRIANGLES


@pytest.mark.parametrize(
    ("broken", "named"),
    [
        ("scene_gt.json", "scene_gt"),
        ("scene_camera.json", "scene_camera"),
        ("models/obj_000001.ply", "obj_000001"),
        ("depth/000001.png", "depth"),
        ("mask_visib/000001_000000.png", "mask_visib"),
    ],
)
@pytest.mark.parametrize("how", ["missing", "garbage"])
def test_a_file_that_is_missing_or_broken_is_named(broken, named, how, folder):
    (folder / broken).unlink()
    if how == "garbage":
        (folder / broken).write_bytes(b"\x00\x01garbage")

    def read():
        scene = BopScene(folder)
        scene.model(1)
        scene.read_frame(1)

    with pytest.raises(InputError, match=named):
        read()


def test_a_picture_without_a_camera_is_named(folder):
    cameras = json.loads((folder / "scene_camera.json").read_text())
    (folder / "scene_camera.json").write_text(json.dumps({"0": cameras["0"]}))
    with pytest.raises(InputError, match="1: found missing"):
        BopScene(folder)


def test_a_mask_of_another_size_is_refused(folder):
    cv2.imwrite(str(folder / "mask_visib" / "000000_000000.png"), np.zeros((10, 20), np.uint8))
    with pytest.raises(InputError, match=r"20 x 10.*64 x 48"):
        BopScene(folder).read_frame(0)


def test_depth_with_colours_is_refused(folder):
    cv2.imwrite(str(folder / "depth" / "000000.png"), np.zeros((48, 64, 3), np.uint8))
    with pytest.raises(InputError, match="3 channels"):
        BopScene(folder).read_frame(0)


def test_the_size_of_a_picture(folder):
    assert BopScene(folder).size(0) == (48, 64)
    (folder / "depth" / "000000.png").unlink()
    with pytest.raises(InputError, match="no picture 000000"):
        BopScene(folder).size(0)
