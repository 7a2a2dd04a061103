import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.map.belief import Belief, BeliefCfg
from coral.reef.map.landmark_map import LandmarkMap
from coral.reef.map.landmarks import Sighting
from coral.reef.map.mapping import MapCfg, OccupancyMap
from coral.reef.sea.saved_survey import load_survey, save_survey
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import load_world


@pytest.fixture(scope="module")
def known():
    """What a robot knows after a turn on the spot in s1."""
    world, cfg = load_world("s1"), CameraCfg()
    camera = Camera(Scene.from_world(world), cfg)
    belief = Belief(OccupancyMap(world.size_m, cfg))
    for k in range(60):
        pose = Pose(world.start.x + 0.05 * k, world.start.y, world.start.theta + 0.1 * k)
        belief.update(camera.render(pose), pose)
    return world, belief, pose


def load(folder, size_m, cell_m=0.05):
    return load_survey(folder, size_m, CameraCfg(), MapCfg(cell_m=cell_m), BeliefCfg())


def test_a_saved_survey_is_known_again(known, tmp_path):
    world, belief, _ = known
    save_survey(tmp_path, belief, LandmarkMap())
    again, _ = load(tmp_path, world.size_m)
    assert np.array_equal(again.map.cells(), belief.map.cells())
    assert {t.index for t in again.tracks} == {t.index for t in belief.tracks}
    assert np.allclose(again.trajectory, belief.trajectory)


def test_clusters_keep_their_labels_and_what_is_done_when_the_survey_goes_on(known, tmp_path):
    world, belief, pose = known
    save_survey(tmp_path, belief, LandmarkMap())
    again, _ = load(tmp_path, world.size_m)
    view = Camera(Scene.from_world(world), CameraCfg()).render(pose)
    for one in (belief, again):
        for _ in range(6):
            one.update(view, pose)

    def seen(one):
        return {(t.index, t.visited, round(t.inspected, 3)) for t in one.tracks if not t.far}

    assert seen(again) == seen(belief)


@pytest.mark.parametrize("content", [None, b"", b"no archive"])
def test_what_is_no_saved_survey_is_one_line(tmp_path, content):
    if content is not None:
        (tmp_path / "survey.npz").write_bytes(content)
    with pytest.raises(InputError):
        load(tmp_path, (20.0, 20.0))


def test_another_area_or_cell_size_is_refused(known, tmp_path):
    world, belief, _ = known
    save_survey(tmp_path, belief, LandmarkMap())
    for size_m, cell_m in (((5.0, 5.0), 0.05), (world.size_m, 0.1)):
        with pytest.raises(InputError, match="size_m"):
            load(tmp_path, size_m, cell_m)


def with_a_landmark(pose):
    return LandmarkMap().extended(Sighting(-0.1, 0.1, 2.0, 0.2), pose, 1.0)


def test_landmarks_are_known_again(known, tmp_path):
    world, belief, pose = known
    save_survey(tmp_path, belief, with_a_landmark(pose))
    *_, again = load(tmp_path, world.size_m)
    assert np.array_equal(again.centres, with_a_landmark(pose).centres)


def test_a_survey_of_before_landmarks_were_saved_has_none(known, tmp_path):
    world, belief, pose = known
    save_survey(tmp_path, belief, with_a_landmark(pose))
    arrays = dict(np.load(tmp_path / "survey.npz"))
    for change, count in (({"landmarks": np.ones((2, 4))}, None), ({}, 0)):
        kept = {name: array for name, array in (arrays | change).items() if change or "landmark" not in name}
        np.savez(tmp_path / "survey.npz", **kept)
        if count is None:
            with pytest.raises(InputError, match="landmarks"):
                load(tmp_path, world.size_m)
        else:
            assert len(load(tmp_path, world.size_m)[1].centres) == count
