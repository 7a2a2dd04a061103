"""Messages that we write, and a place that is taken."""

import pytest

from coral.errors import InputError
from coral.ros.bag_reader import Bag
from coral.ros.bag_writer import nanoseconds_of, open_bag

pytest.importorskip("rosbags")
TOPICS = dict.fromkeys(("/told", "/silent"), ("std_msgs/msg/String", "a text"))


@pytest.mark.parametrize("single_file", [True, False])
def test_what_is_sent_is_read_and_what_is_there_stays(tmp_path, single_file):
    path = tmp_path / ("told.mcap" if single_file else "told")
    with open_bag(path, TOPICS, single_file=single_file) as bag:
        bag.send("/told", 0.5, bag.text("here"))
    assert bag.counts == Bag(path).count_messages() == {"/told": 1}
    assert [message.data for _, message in Bag(path).read_messages({"/told"})] == ["here"]
    assert list(tmp_path.iterdir()) == [path]
    with (
        pytest.raises(InputError, match="something that exists already"),
        open_bag(path, TOPICS, single_file=single_file),
    ):
        pass


def test_a_bag_that_fails_midway_leaves_nothing(tmp_path):
    def write():
        with open_bag(tmp_path / "x.mcap", TOPICS, single_file=True) as bag:
            bag.send("/told", 0.0, bag.text("here"))
            bag.send("/unknown", 0.0, bag.text("here"))

    with pytest.raises(KeyError):
        write()
    assert list(tmp_path.iterdir()) == []


def test_times_are_whole_nanoseconds():
    assert nanoseconds_of(0.3) == 300_000_000
