import time

from coral.reef.ros.newest import OLD_S, Newest
from coral.ros.ros_node import OtherClockError
from reef.ros.fake_ros import FakeNode, message


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
