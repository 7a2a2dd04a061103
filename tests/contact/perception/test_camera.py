import mujoco
import numpy as np
import pytest
from ball_before_wall import scene
from solid_object import solid

from coral.config import checked
from coral.contact.perception.camera import (
    RgbdCameraCfg,
    RgbdFrame,
    draw_depth,
    hidden_geoms,
    instance_names,
    look_at,
    shade,
)
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.real_scenes.posed_scene import PosedScene
from coral.contact.scene.geometry import pose_matrix
from coral.errors import InputError


def test_a_wall_one_metre_away_and_a_ball_before_it():
    camera, data = scene()
    frame = camera.take(data)
    assert frame.depth[0, 0] == pytest.approx(1.0)
    assert frame.depth[60, 80] == pytest.approx(0.7, abs=1e-3)
    # A ball of radius 0.1 at 0.8 m covers a disc of f * 0.1 / sqrt(0.8^2 - 0.1^2).
    radius = camera.cfg.lens[0] * 0.1 / np.sqrt(0.63)
    assert frame.mask("ball").sum() == pytest.approx(np.pi * radius**2, rel=0.03)
    with pytest.raises(KeyError):
        frame.mask("wall")


def test_world_points_project_where_they_are_seen():
    T = look_at((0.4, -0.3, 0.5), (0.0, 0.1, 0.0))
    np.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-12)
    target = np.linalg.inv(T) @ [0.0, 0.1, 0.0, 1.0]
    np.testing.assert_allclose(target[:2], 0.0, atol=1e-12)
    assert target[2] > 0
    above = np.linalg.inv(T) @ [0.0, 0.1, 0.1, 1.0]
    assert above[1] < 0  # y points down


def test_colours_are_those_of_the_geoms():
    camera, data = scene(colours=True)
    rgb = camera.take(data).rgb
    assert rgb[60, 80, 0] > 150
    assert rgb[60, 80, 1] == 0
    assert abs(int(rgb[5, 5, 0]) - int(rgb[5, 5, 1])) < 2


@pytest.mark.parametrize("bad", [{"width": 4}, {"vfov_deg": 180.0}, {"near_m": 0.0}, {"far_m": 0.0}])
def test_a_bad_camera_is_named(bad):
    with pytest.raises(InputError, match=next(iter(bad))):
        checked(RgbdCameraCfg(**bad), "camera")


LENS = np.array([1.0, 1.0, 0.0, 0.0])
"""Of a picture whose pixel (0, 0) looks straight ahead and (0, 1) 45 degrees to the right."""
WHITE = np.ones((1, 3))
AHEAD, UP = [0.0, 0.0, -1.0], [0.0, -1.0, 0.0]


def light(*normals):
    """Red, green and blue of a row of white pixels with these normals."""
    return shade(np.array([normals]), np.zeros((1, len(normals)), np.int64), WHITE, LENS)[0].tolist()


def test_a_pixel_has_the_colour_of_its_solid_and_the_rest_is_sky():
    colours = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    (row,) = shade(np.array([[AHEAD, AHEAD]]), np.array([[1, -1]]), colours, LENS)
    assert row.tolist() == [[0, 0, 179], [191, 209, 230]]


def test_a_surface_that_faces_the_camera_has_the_headlight_on_it():
    assert light(AHEAD) == [[179] * 3]  # (0.3 + 0.4) of 255


def test_the_headlight_falls_with_the_angle_to_the_ray():
    assert light(AHEAD, AHEAD)[1] == [149] * 3  # (0.3 + 0.4 cos 45) of 255


def test_a_surface_that_faces_up_has_the_lamp_on_it():
    assert light(UP) == [[153] * 3]  # (0.3 + 0.3) of 255


def test_a_box_is_drawn_where_it_is():
    box = solid(("box", (0.05, 0.05, 0.05)))
    nothing, lens = np.zeros((48, 64), np.float32), np.array([100.0, 100.0, 31.5, 23.5])
    frame = RgbdFrame(nothing, nothing.astype(np.uint8), (), lens, np.eye(4))
    depth = draw_depth(box.solids, pose_matrix(np.eye(3), [0.0, 0.0, 1.0]), frame)
    assert depth[24, 32] == pytest.approx(0.95)
    assert np.isinf(depth[0, 0])
    rows, columns = np.nonzero(np.isfinite(depth))
    assert (rows.max() - rows.min(), columns.max() - columns.min()) == (9, 9)  # 0.1 m at 0.95 m


SCENE = """<mujoco><worldbody>
  <geom name="floor" type="plane" size="1 1 1"/>
  <geom name="table" type="box" size=".4 .4 .1"/>
  <geom name="wall" type="box" size=".1 .1 .1"/>
  <body name="link"><joint/>
    <geom name="link_collision" size=".1" group="0"/><geom name="link_visual" size=".1" group="1"/>
  </body>
  <body name="finger"><joint/><geom name="finger_collision" size=".1" group="0"/></body>
  <body name="box"><freejoint/><geom name="box_part" size=".1" group="0"/>
    <geom name="box_label" size=".1" group="1"/></body>
  <body name="can"><freejoint/><geom name="can_part" size=".1" group="0"/></body>
</worldbody></mujoco>"""


@pytest.fixture(scope="module")
def model():
    return mujoco.MjModel.from_xml_string(SCENE)


def test_what_moves_is_an_object_or_the_robot_and_the_rest_has_no_name(model, trial):
    named = {model.geom(geom).name: name for geom, name in instance_names(model, trial).items()}
    assert named == {
        "link_collision": "robot",
        "link_visual": "robot",
        "finger_collision": "robot",
        "box_part": "box",
        "box_label": "box",
        "can_part": "can",
    }


def test_people_see_the_robot_as_it_looks_and_no_room(model, trial):
    hidden = {model.geom(geom).name for geom in hidden_geoms(model, trial)}
    assert hidden == {"floor", "link_collision"}


def test_in_a_scene_of_a_trial_every_object_has_its_geoms(trial):
    scene = PosedScene(trial, TrackedCfg()).model
    assert set(instance_names(scene, trial).values()) == {"box", "can", "robot"}
