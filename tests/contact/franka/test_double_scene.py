"""The double's scene: a trial's elements, and contact forces on the hand. A hand of two bodies stands for the arm."""

import xml.etree.ElementTree as ET

import mujoco
import numpy as np
import pytest
from episodes import make_trial

from coral.contact.franka.double_scene import DoubleScene, make_rubber, part_of, scene_elements


@pytest.fixture(scope="module")
def scene():
    """The hand stands on the box with its own weight of 0.5 kg."""
    trial = make_trial()
    root = ET.fromstring("<mujoco><compiler angle='radian'/><worldbody/><asset/><contact/></mujoco>")
    for section, elements in scene_elements(trial).items():
        root.find(section).extend(elements)
    box = trial.objects["box"].pose.position
    height = 2 * box[2] + 0.012
    hand = ET.SubElement(root.find("worldbody"), "body", name="robot0_hand", pos=f"{box[0]} {box[1]} {height}")
    ET.SubElement(hand, "joint", type="slide", axis="0 0 1")
    ET.SubElement(hand, "geom", name="palm", type="box", size="0.02 0.02 0.01", mass="0.5")
    for side in ("left", "right"):
        finger = ET.SubElement(hand, "body", name=f"robot0_{side}_finger", pos="0 0 0.05")
        ET.SubElement(finger, "geom", name=side, type="box", size="0.005 0.005 0.005", mass="0.001")
    model = mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"))
    make_rubber(model)
    data = mujoco.MjData(model)
    found = DoubleScene(model, data, trial)
    for _ in range(600):
        mujoco.mj_step(model, data)
        wrench = found.measure()
    return model, found, wrench


def test_the_table_carries_the_hand_through_the_box(scene):
    assert scene[2][:3] == pytest.approx([0, 0, 0.502 * 9.81], abs=0.1)


def test_the_torque_counts_about_the_tool(scene):
    _, found, wrench = scene
    place = found.tool_m()
    assert place[2] - found._data.xpos[found._hand][2] == pytest.approx(0.1034)
    assert np.abs(wrench[3:]).max() < 0.05  # the force goes through the tool's axis


def test_the_truth_has_contacts_and_the_forces_since_it_was_asked(scene):
    _, found, _ = scene
    truth = found.truth(1.0, found.poses()["box"], 0.08)
    assert {(one.first, one.second) for one in truth.contacts} == {("box", "hand"), ("box", "table")}
    assert truth.hand_forces["box"].peak > 4.0
    assert truth.hand_forces["box"].mean[2] < -3.0
    again = found.truth(1.0, found.poses()["box"], 0.08)
    assert again.hand_forces["box"].mean is None
    assert again.hand_forces["box"].peak == 0.0


def test_parts_have_the_judges_names(scene):
    model = scene[0]
    names = {part_of(model, geom) for geom in range(model.ngeom)}
    assert names == {"table", "box", "hand", "left", "right"}


def test_only_the_pads_get_the_rubbers_friction(scene):
    model = scene[0]
    assert model.geom("left").friction[0] == 1.0
    assert model.geom("left").priority[0] == 2
    assert model.geom("palm").priority[0] == 0
