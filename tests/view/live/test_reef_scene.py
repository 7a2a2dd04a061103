import dataclasses

import numpy as np
import pytest

from coral.reef.world.geometry import Frame, Pose
from coral.reef.world.world import load_world
from coral.view.live import reef_scene
from coral.view.live.story import Story
from coral.view.mapview import MapScene


def test_the_truth_is_a_layer_of_its_own():
    world = load_world("l1")
    (line,) = reef_scene.truth(world)
    assert line.layer == "truth"
    xy = line.segments[..., :2].reshape(-1, 2)
    oyster = world.clusters[0].oysters[0]
    assert np.hypot(*(xy - (oyster.x, oyster.y)).T).min() < max(oyster.radii)
    assert reef_scene.truth(None) == ()


SCENE = MapScene(
    cells=np.zeros((4, 4), np.uint8),
    cell_m=0.5,
    pose=Pose(1.0, 2.0, np.pi / 2),
    trajectory=np.array([(0.0, 0.0), (1.0, 2.0)]),
    centroids=np.array([(1.0, 1.0), (2.0, 1.0), (3.0, 1.0)]),
    indices=(4, 7, 9),
    visited=(True, False, False),
    chain=(2, 0, 1),
    goal=(3.0, 1.0),
)


def test_the_robot_stands_at_its_pose_and_faces_along_it():
    (body,) = reef_scene.robot(SCENE.pose)
    assert body.position[:2] == (1.0, 2.0)
    w, _, _, z = body.wxyz
    assert 2 * np.arctan2(z, w) == pytest.approx(np.pi / 2)
    assert reef_scene.robot(None) == ()


def test_lines_follow_the_scene_and_are_empty_where_it_has_none():
    drawn = {line.name: line.segments for line in reef_scene.lines(SCENE, np.array([(0.0, 0.0, 1.0), (1.0, 1.0, 1.0)]))}
    assert drawn["chain"][:, 0, 0].tolist() == [3.0, 1.0]
    assert drawn["plan"].shape == drawn["trajectory"].shape == (1, 2, 3)
    assert drawn["goal"][..., :2].mean(axis=(0, 1)) == pytest.approx((3.0, 1.0), abs=1e-5)
    bare = {line.name: len(line.segments) for line in reef_scene.lines(MapScene(cells=SCENE.cells, cell_m=0.5))}
    assert set(bare.values()) == {0}
    assert set(bare) == set(drawn)


def test_dots_have_their_numbers_and_pale_once_they_were_visited():
    dots = reef_scene.markers(SCENE)
    assert [dot.label for dot in dots] == ["4", "7", "9"]
    assert [dot.color == reef_scene.PALE_ORANGE for dot in dots] == [True, False, False]


@pytest.mark.parametrize(("coverage", "tone"), [(0.994, "plain"), (1.0, "good")])
def test_numbers_tell_good_from_bad(coverage, tone):
    story = Story(covered=2, clusters=3, collisions=1, calls=4, requeries=1)
    found = {n.name: (n.value, n.tone) for n in reef_scene.numbers(story, coverage, 0.126)}
    assert found["coverage"][1] == tone
    assert found["clusters"] == ("2 of 3", "plain")
    assert found["collisions"] == ("1", "bad")
    assert found["advisor calls"] == ("4 (1 again)", "plain")
    assert found["speed"] == ("0.13 m/s", "plain")


@pytest.mark.parametrize(("state", "tone"), [("surveying", "plain"), ("holding", "bad"), ("surfacing", "bad")])
def test_the_state_of_the_vehicle_is_shown(state, tone):
    shown = reef_scene.numbers(Story(state=state), 0.5, 0.0)[-1]
    assert (shown.name, shown.value, shown.tone) == ("state", state, tone)


def test_the_page_shows_colours_first_where_the_camera_takes_them():
    plain = Frame(np.ones((12, 16), np.float32), np.ones((12, 16), np.uint8), np.zeros((12, 16), np.int32))
    coloured = dataclasses.replace(plain, rgb=np.zeros((12, 16, 3), np.uint8))
    assert [name.split(":")[0] for name, _ in reef_scene.cameras(plain)] == ["Camera", "Depth"]
    assert [name.split(":")[0] for name, _ in reef_scene.cameras(coloured)] == ["Camera", "Classes", "Depth"]
    assert not reef_scene.cameras(coloured)[0][1].any()
