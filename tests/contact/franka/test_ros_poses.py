"""Poses of objects from ROS 2's topics, without ROS 2: they arrive at the port to which every tracker sends."""

import numpy as np
import pytest
from arms import DOWN, TOOL

from contact.franka.test_ros_arm import header, posed
from coral.contact.franka import ros_poses
from coral.contact.franka.object_poses import ObjectPoses
from coral.contact.scene.observation import BodyState
from reef.ros.fake_ros import FakeNode, message

BASE = np.array([-0.5, 0.0, 0.0])


class Bench:
    def __init__(self, **parameters):
        self.node, self.port = FakeNode(), ObjectPoses(("box", "tall-can"), "127.0.0.1", 0)
        self.node.parameter = lambda name, usual: parameters.get(name.replace(".", "_").replace("-", "_"), usual)
        self.poses = ros_poses.RosPoses(self.node, self.port.names, BASE, ("127.0.0.1", self.port.port))

    def tell(self, topic, seconds, frame="world", position=(0.1, 0.0, 0.03), quaternion=(1.0, 0.0, 0.0, 0.0)):
        self.node.heard[topic](message(header=header(seconds, frame), pose=posed(position, quaternion)))

    def found(self, now_s=1.0, tool=None):
        self.port.update(now_s, tool)
        return self.port.poses


@pytest.fixture
def make(monkeypatch):
    monkeypatch.setattr(ros_poses, "ros_type", lambda name, flag: name)
    made = []

    def bench(**parameters):
        made.append(Bench(**parameters))
        return made[-1]

    yield bench
    for each in made:
        each.poses.close()
        each.port.close()


def test_each_object_has_its_topic(make):
    bench = make()
    bench.tell("objects/box", 1.0)
    bench.tell("objects/tall_can", 1.0, position=(0.0, 0.2, 0.05), quaternion=(0.0, 0.0, 0.0, 1.0))
    found = bench.found()
    assert found["box"].position == pytest.approx([0.1, 0.0, 0.03])
    assert found["tall-can"].position == pytest.approx([0.0, 0.2, 0.05])
    assert found["tall-can"].quaternion == pytest.approx([0.0, 0.0, 0.0, 1.0])


def test_frames_are_converted_and_unknown_ones_ignored(make):
    bench = make()
    bench.tell("objects/box", 1.0, "fr3_link0", position=(0.6, 0.0, 0.03))
    assert bench.found()["box"].position == pytest.approx([0.1, 0.0, 0.03])
    bench.tell("objects/box", 2.0, "camera_link", position=(9.0, 9.0, 9.0))
    assert bench.found(2.0)["box"].position == pytest.approx([0.1, 0.0, 0.03])
    assert bench.port.age_s("box", 2.0) == 1.0
    bench.tell("objects/box", 3.0, "fr3_hand_tcp", position=(0.0, 0.0, 0.05))
    held = bench.found(3.0, BodyState(TOOL + BASE, DOWN))["box"]
    assert held.position == pytest.approx(TOOL + BASE - [0.0, 0.0, 0.05])


def test_a_repeated_pose_is_no_new_one(make):
    bench = make()
    bench.tell("objects/box", 1.0)
    bench.found(1.0)
    for _ in range(3):
        bench.tell("objects/box", 1.0)
    bench.found(5.0)
    assert bench.port.age_s("box", 5.0) == 4.0


def test_numbers_that_are_no_pose_are_counted(make):
    bench = make()
    bench.tell("objects/box", 1.0, position=(np.nan, 0.0, 0.0))
    assert bench.found() == {}
    assert bench.port.malformed == 1


def test_a_detector_names_objects_by_class_or_id(make):
    bench = make(detections="detections")

    def detection(of, id, score, x):
        result = {"hypothesis": {"class_id": of, "score": score}, "pose": {"pose": posed((x, 0.0, 0.0))}}
        return message(id=id, results=[message(**result)])

    other = detection("crate", "", 0.9, 7.0)
    two = detection("box", "", 0.4, 0.5)
    two.results += detection("box", "", 0.8, 0.2).results
    unnamed = detection("object", "tall-can", 0.5, 0.3)
    bench.node.heard["detections"](
        message(header=header(1.0, "world"), detections=[other, two, unnamed, message(id="box", results=[])])
    )
    found = bench.found()
    assert {name: pose.position[0] for name, pose in found.items()} == {"box": 0.2, "tall-can": 0.3}
