import time

import pytest

from coral.errors import InputError
from coral.ros.ros_node import OLD_S, Newest, OtherClockError, ros_type, ros_words
from reef.ros.fake_ros import FakeNode, message


def test_without_ros_the_flag_and_the_way_out_are_named():
    with pytest.raises(InputError, match=r"--camera: found no nowhere_msgs .* source its setup.bash"):
        ros_type("nowhere_msgs.msg.Image", "--camera")


def test_a_place_is_a_namespace_and_files(tmp_path):
    one, two = tmp_path / "one.yaml", tmp_path / "two.yml"
    one.touch()
    two.touch()
    assert ros_words("", "--vehicle") == []
    assert ros_words("bluerov2/", "--vehicle") == ["--ros-args", "-r", "__ns:=/bluerov2"]
    words = ["--ros-args", "-r", "__ns:=/rov", "--params-file", str(one), "--params-file", str(two)]
    assert ros_words(f"/rov,{one},{two}", "--vehicle") == words
    with pytest.raises(InputError, match=r"--vehicle: found 'ros2:nowhere.yaml'|ros2:nowhere.yaml"):
        ros_words("/rov,nowhere.yaml", "--vehicle")


def test_the_last_of_several_is_kept_and_taken_once():
    newest = Newest(FakeNode())
    for stamp in (1.0, 2.0, 3.0):
        newest.hear(message(header={"stamp": stamp}))
    stamp_s, last = newest.take(0.0)
    assert stamp_s == last.header.stamp == 3.0
    assert newest.take(0.0) is None


def test_what_is_of_another_clock_counts_as_old():
    newest = Newest(FakeNode())
    newest.hear(message(header={"stamp": OtherClockError("")}))
    assert newest.take(0.0)[0] < time.monotonic() - 0.9 * OLD_S
