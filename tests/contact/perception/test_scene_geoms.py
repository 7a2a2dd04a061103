import mujoco
import pytest

from coral.contact.perception.scene_geoms import hidden_geoms, instance_names
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.real_scenes.posed_scene import PosedScene

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
