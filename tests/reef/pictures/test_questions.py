import cv2
import numpy as np
import pytest

from coral.reef.decide.outlook import Outlook
from coral.reef.map.belief import Belief
from coral.reef.map.mapping import OccupancyMap
from coral.reef.pictures.questions import map_scene, question_pictures
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Frame, Pose


@pytest.fixture
def belief():
    belief = Belief(OccupancyMap((20.0, 16.0), CameraCfg()))
    belief.pose = Pose(7.0, 4.0, 2.0)
    belief.goal = (12.0, 9.0)
    return belief


def test_the_map_says_where_the_world_lies_in_it(belief):
    (picture,) = question_pictures(Outlook.now(belief))
    rgb = cv2.imdecode(np.frombuffer(picture.png, np.uint8), cv2.IMREAD_COLOR)[:, :, ::-1]
    column, row = np.array(picture.pixel_from_world) @ (belief.pose.x, belief.pose.y, 1.0)
    red, green, blue = rgb[round(row), round(column)].astype(int)
    assert red > 180 > 80 > max(green, blue)
    # The goal's cross-hair leaves a hole in its middle and is magenta 13 px beside it.
    column, row = np.array(picture.pixel_from_world) @ (*belief.goal, 1.0)
    red, green, blue = rgb[round(row), round(column) + 13].astype(int)
    assert min(red, blue) > 120 > 80 > green


def test_the_camera_is_shown_once_it_has_seen_something(belief):
    assert [picture.name for picture in question_pictures(Outlook.now(belief))] == ["map"]
    belief.frame = Frame(np.ones((12, 16), np.float32), np.zeros((12, 16), np.uint8), np.zeros((12, 16), np.int32))
    pictures = question_pictures(Outlook.now(belief))
    assert [picture.name for picture in pictures] == ["map", "segmentation", "depth"]
    assert all(picture.caption for picture in pictures)
    assert [picture.pixel_from_world is None for picture in pictures] == [False, True, True]


def test_the_scene_is_what_the_robot_believes(belief):
    scene = map_scene(Outlook.now(belief))
    assert (scene.pose, scene.goal, len(scene.centroids)) == (belief.pose, belief.goal, 0)
    np.testing.assert_array_equal(scene.cells, belief.map.cells())
