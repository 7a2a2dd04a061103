"""The names of an arm's topics: what a parameter says, or the usual one."""

from types import SimpleNamespace

from coral.contact.franka.ros_topics import TOPICS, topic


def test_a_parameter_renames_a_topic_and_an_object_has_a_name_that_ros_takes():
    given = {"wrench": "/mine", "poses.tall-can": "/tracker/can"}
    ros = SimpleNamespace(parameter=given.get)
    assert topic(ros, "wrench") == "/mine"
    assert topic(ros, "gripper_opening") == "franka_gripper/opening"
    assert topic(ros, "poses.NAME", "tall-can") == "/tracker/can"
    assert topic(ros, "poses.NAME", "red-box") == "objects/red_box"


def test_every_topic_is_told_with_its_parameter():
    assert "Parameter `stop`" in TOPICS["stop"][1]
    assert "arameter" not in TOPICS["coral/stop"][1]
