import json

import numpy as np
import pytest
from recorded_scenes import write_scene

from coral.contact.perception.mesh_file import read_mesh
from coral.contact.perception.tracker import PoseEstimate
from coral.contact.real_scenes.bop_scene import BopScene
from coral.contact.real_scenes.bop_writing import write_bop_results, write_ply
from coral.contact.real_scenes.recorded_accuracy import judge_pose
from coral.errors import InputError


def test_what_was_written_is_read_again(trial, tmp_path):
    models, frames, truths = write_scene(tmp_path / "scene", trial)
    scene = BopScene(tmp_path / "scene")
    assert scene.pictures == [0, 1]
    assert scene.objects == [1, 2]
    for picture, (frame, truth) in enumerate(zip(frames, truths, strict=True)):
        read = scene.read_frame(picture)
        assert np.abs(read.depth - frame.depth).max() <= 0.00005 + 1e-6
        assert np.allclose(read.lens, frame.lens)
        assert np.allclose(read.T_world_camera, frame.T_world_camera)
        for k, name in enumerate(models):
            assert np.array_equal(read.mask(str(k)), frame.mask(name))
            assert np.allclose(scene.truth(picture, k), truth[name], atol=1e-9)


def test_models_and_symmetries_are_read_again(trial, tmp_path):
    models, _, _ = write_scene(tmp_path / "scene", trial)
    scene = BopScene(tmp_path / "scene")
    for number, (_, model) in enumerate(models.items(), 1):
        read = scene.model(number)
        assert read.diameter == pytest.approx(model.diameter, rel=0.02)
        assert len(read.symmetry.rotations) == len(model.symmetry.rotations)
        assert (read.symmetry.axis is None) == (model.symmetry.axis is None)
        assert np.allclose(read.symmetry.center, model.symmetry.center, atol=1e-6)


def test_a_surface_is_the_same_after_a_file(tmp_path):
    triangles = np.array([[[0, 0, 0], [0.1, 0, 0], [0, 0.2, 0]], [[0, 0, 0], [0.1, 0, 0], [0, 0, 0.3]]])
    write_ply(tmp_path / "one.ply", triangles)
    assert np.allclose(read_mesh(tmp_path / "one.ply", 0.001), triangles)


def test_nothing_of_the_user_s_is_overwritten(trial, tmp_path):
    (tmp_path / "scene").mkdir()
    (tmp_path / "scene" / "mine.txt").write_text("mine")
    with pytest.raises(InputError, match="new or empty"):
        write_scene(tmp_path / "scene", trial)


def test_results_are_in_millimetres_in_the_camera_s_frame(trial, tmp_path):
    models, _, _ = write_scene(tmp_path / "000003", trial)
    scene = BopScene(tmp_path / "000003")
    model, truth = next(iter(models.values())), scene.truth(1, 0)
    found = [
        judge_pose(1, model, 1, PoseEstimate(truth, 0.9, lost), truth, followed, 1.0, 0.25)
        for followed in (False, True)
        for lost in (False, True)
    ]
    write_bop_results(tmp_path / "results.csv", scene, found)
    head, row = (tmp_path / "results.csv").read_text().splitlines()  # neither lost nor followed poses
    assert head == "scene_id,im_id,obj_id,score,R,t,time"
    scene_id, picture, number, score, turn, place, seconds = row.split(",")
    assert (scene_id, picture, number, score, seconds) == ("3", "1", "1", "0.9000", "0.2500")
    written = json.loads((tmp_path / "000003" / "scene_gt.json").read_text())["1"][0]
    assert np.allclose([float(word) for word in place.split()], written["cam_t_m2c"], atol=1e-5)
    assert np.allclose([float(word) for word in turn.split()], written["cam_R_m2c"], atol=1e-5)
