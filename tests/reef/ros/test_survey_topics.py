import json
from types import SimpleNamespace

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.map.mapping import FREE, OBSTACLE, TARGET, UNEXPLORED
from coral.reef.ros import survey_topics
from coral.reef.ros.survey_topics import MapTransform
from coral.reef.sea.operator import OperatorWords
from coral.reef.world.geometry import Pose
from coral.reef.world.instruction import checked_words
from reef.ros.fake_ros import FakeNode, fake_type, message


def test_a_grid_has_ros_values_row_by_row():
    cells = np.array([[UNEXPLORED, FREE], [OBSTACLE, TARGET]], np.uint8)
    assert survey_topics.grid_values(cells).tolist() == [-1, 0, 100, 50]


@pytest.mark.parametrize(("service", "word"), [("start", "arm"), ("hold", "hold"), ("home", "home"), ("stop", "stop")])
def test_services_are_the_operators_words(monkeypatch, service, word):
    monkeypatch.setattr(survey_topics, "ros_type", fake_type)
    node, words = FakeNode(), OperatorWords()
    survey_topics.SurveyTopics("", words, node=node)
    answer = node.services[f"coral/{service}"](None, SimpleNamespace())
    assert answer.success
    assert words.take() == [(word, "ROS 2")]


def test_the_instruction_is_a_topic_and_another_one_changes_it(monkeypatch):
    monkeypatch.setattr(survey_topics, "ros_type", fake_type)
    node, told = FakeNode(), []
    run = SimpleNamespace(
        instruction="Find the net.", record=SimpleNamespace(listeners=[]), pose=None, end_reason="",
    )  # fmt: skip

    def instruct(words, by):
        told.append((checked_words(words), by))
        return True

    topics = survey_topics.SurveyTopics("", OperatorWords(), instruct, node)
    topics._due_s = float("inf")
    topics.tick(run)
    topics.tick(run)
    node.heard["coral/instruct"](SimpleNamespace(data="Find the tyre."))
    node.heard["coral/instruct"](SimpleNamespace(data=" "))
    run.instruction = "Find the tyre."
    topics.tick(run)
    assert told == [("Find the tyre.", "ROS 2")]
    assert [m.data for topic, m in node.sent if topic == "coral/instruction"] == ["Find the net.", "Find the tyre."]
    (refused,) = [json.loads(m.data) for topic, m in node.sent if topic == "coral/events"]
    assert (refused["event"], "some words" in refused["reason"]) == ("instruction_refused", True)


@pytest.mark.parametrize("goal", [(3.0, 4.0), None])
def test_the_goal_is_told_if_there_is_one(monkeypatch, goal):
    def shape():
        point, turn = {"x": 0.0, "y": 0.0, "z": 0.0}, {"z": 0.0, "w": 1.0}
        return message(header={"frame_id": "", "stamp": 0.0}, pose={"position": point, "orientation": turn})

    made = {"geometry_msgs.msg.PoseStamped": shape}
    monkeypatch.setattr(survey_topics, "ros_type", lambda name: made.get(name) or fake_type(name))
    node = FakeNode()
    topics = survey_topics.SurveyTopics("", OperatorWords(), node=node)
    topics._publish_goal(SimpleNamespace(belief=SimpleNamespace(goal=goal)))
    told = [(topic, m.header.frame_id, m.pose.position.x, m.pose.position.y) for topic, m in node.sent]
    assert told == ([] if goal is None else [("coral/goal", "map", 3.0, 4.0)])


def test_a_survey_without_an_instruction_has_no_topic_to_change_it(monkeypatch):
    monkeypatch.setattr(survey_topics, "ros_type", fake_type)
    node = FakeNode()
    survey_topics.SurveyTopics("", OperatorWords(), node=node)
    assert "coral/instruct" not in node.heard


def transform(parent="", child="", stamp=0.0):
    zero = {"x": 0.0, "y": 0.0, "z": 0.0}
    placed = {"translation": zero, "rotation": {**zero, "w": 1.0}}
    return message(header={"frame_id": parent, "stamp": stamp}, child_frame_id=child, transform=placed)


@pytest.fixture
def types(monkeypatch):
    stamped = "TransformStamped"
    monkeypatch.setattr(
        survey_topics, "ros_type", lambda name: transform if name.endswith(stamped) else fake_type(name)
    )


def sent(node):
    return [each for topic, told in node.sent if topic == "/tf" for each in told.transforms]


def test_what_is_sent_says_where_the_odometry_is_in_the_map(types):
    node = FakeNode(stamp_s=7.0)
    made = MapTransform(node)
    made.publish("odom", Pose(1.0, 2.0, 0.0), Pose(4.0, 6.0, 0.0))
    (found,) = sent(node)
    assert (found.header.frame_id, found.child_frame_id, found.header.stamp) == ("map", "odom", 7.0)
    assert (found.transform.translation.x, found.transform.translation.y) == (3.0, 4.0)
    assert (found.transform.rotation.z, found.transform.rotation.w) == (0.0, 1.0)
    assert made.told == "map -> odom"


@pytest.mark.parametrize("frame", ["", "map"])
def test_odometry_in_the_map_needs_none(types, frame):
    node = FakeNode()
    MapTransform(node).publish(frame, Pose(0.0, 0.0, 0.0), Pose(1.0, 0.0, 0.0))
    assert sent(node) == []


def test_nothing_is_sent_where_it_is_switched_off(types):
    node = FakeNode()
    node.parameter = lambda name, default: {"publish_tf": "False"}.get(name, default)
    made = MapTransform(node)
    made.publish("odom", Pose(0.0, 0.0, 0.0), Pose(1.0, 0.0, 0.0))
    assert (sent(node), made.told) == ([], "off: publish_tf")


def test_nothing_is_sent_without_the_messages(types, monkeypatch):
    def missing(name):
        raise InputError("--vehicle", "", "no tf2_msgs", "ROS 2")

    monkeypatch.setattr(survey_topics, "ros_type", missing)
    node = FakeNode()
    made = MapTransform(node)
    made.publish("odom", Pose(0.0, 0.0, 0.0), Pose(1.0, 0.0, 0.0))
    assert (sent(node), made.told) == ([], "off: no tf2_msgs")
