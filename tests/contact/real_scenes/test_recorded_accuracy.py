import dataclasses
import shutil

import numpy as np
import pytest
from recorded_scenes import write_scene

from coral.contact.perception.tracker import PoseEstimate
from coral.contact.real_scenes.bop_scene import BopScene
from coral.contact.real_scenes.recorded_accuracy import SceneTracking, judge_pose, summarize_poses


class Told:
    """Believes what it is told."""

    def __init__(self, model, poses, log):
        self.model, self._poses, self._log = model, poses, log

    def register(self, frame, mask):
        self._log.append(("register", self.model.name))
        return PoseEstimate(self._poses[self.model.name], 1.0)

    def track(self, frame, mask, guess=None):
        self._log.append(("track", self.model.name))
        return PoseEstimate(self._poses[self.model.name], 1.0)

    def close(self):
        self._log.append(("close", self.model.name))


@pytest.fixture
def scene(trial, tmp_path):
    write_scene(tmp_path / "scene", trial, pictures=3)
    return BopScene(tmp_path / "scene")


def told(scene, picture, log):
    poses = {f"obj {one.number}": scene.truth(picture, k) for k, one in enumerate(scene.placed[picture])}
    return lambda model: Told(model, poses, log)


def test_an_object_is_found_afresh_in_each_picture_and_followed_through_successive_ones(scene):
    log = []
    tracking = SceneTracking(scene, told(scene, 0, log))
    found = [[one.followed for one in tracking.poses(k, scene.read_frame(k)) if one.number == 1] for k in (0, 1)]
    assert found == [[False], [False, True]]
    tracking.close()
    assert sum(kind == "close" for kind, _ in log) == sum(kind == "register" for kind, _ in log)


def test_nothing_is_followed_over_a_gap(scene):
    tracking = SceneTracking(scene, told(scene, 0, []))
    found = [one for k in (0, 2) for one in tracking.poses(k, scene.read_frame(k))]
    assert not any(one.followed for one in found)


def test_true_poses_are_without_error(scene):
    poses = SceneTracking(scene, told(scene, 0, [])).poses(0, scene.read_frame(0))
    for row in summarize_poses(poses):
        assert row.mm == pytest.approx(0.0, abs=1e-6)
        assert row.mssd_recall == 1.0
        assert (row.lost, row.false) == (0, 0)


def test_the_measures_of_a_shifted_pose(scene):
    model, truth = scene.model(1), scene.truth(0, 0)
    poses = []
    for share in (0.0, 0.07, 0.42):
        moved = truth.copy()
        moved[:3, 3] += [share * model.diameter, 0, 0]
        poses.append(judge_pose(0, model, 1, PoseEstimate(moved, 1.0), truth, False, 1.0, 0.1))
    [row] = summarize_poses(poses)
    assert row.mm == pytest.approx(70 * model.diameter)
    assert row.mssd_recall == pytest.approx((10 + 9 + 2) / 30)  # thresholds from 0.05 to 0.5 in steps of 0.05
    assert row.false == 1
    lost = dataclasses.replace(poses[2], estimate=PoseEstimate(np.eye(4), 0.0, lost=True))
    [row] = summarize_poses([poses[0], lost])
    assert (row.lost, row.false, row.add_recall) == (1, 0, 0.5)
    assert row.mm == pytest.approx(0.0, abs=1e-6)  # errors of poses that were not lost
    [row] = summarize_poses([lost])
    assert row.mm is None


def test_without_true_masks_none_is_read(trial, tmp_path):
    write_scene(tmp_path / "scene", trial, pictures=3)
    shutil.rmtree(tmp_path / "scene" / "mask_visib")
    scene = BopScene(tmp_path / "scene")
    asked, log = [], []

    class Everything:
        name, wants_colours = "everything", False

        def segment(self, frame, poses):
            asked.append(sorted(poses))
            return {"1": frame.depth > 0}

    truths = {f"obj {one.number}": scene.truth(0, k) for k, one in enumerate(scene.placed[0])}
    tracking = SceneTracking(scene, lambda model: Told(model, truths, log), Everything())
    poses = [one for picture in scene.pictures for one in tracking.poses(picture, scene.read_bare_frame(picture))]
    assert asked == [[], ["1", "2"], ["1", "2"]]  # where they were last is known
    assert {one.number for one in poses} == {1, 2}
    assert all(one.visible > 0.5 for one in poses if one.picture == 0)
