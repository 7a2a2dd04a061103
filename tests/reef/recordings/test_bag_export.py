"""What our bags hold, read by readers that are not ours."""

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.recordings.bag_export import TOPICS, write_bag
from coral.reef.recordings.run_recording import read_run

pytest.importorskip("rosbags")


@pytest.fixture(scope="module")
def mcap_file(survey_run, tmp_path_factory):
    path = tmp_path_factory.mktemp("bags") / "patch.mcap"
    write_bag(read_run(survey_run).located(), path, single_file=True)
    return path


def test_a_bag_is_read_by_rosbags(survey_run, tmp_path):
    from rosbags.highlevel import AnyReader

    counts = write_bag(read_run(survey_run).located(), tmp_path / "patch_bag", single_file=False)
    with AnyReader([tmp_path / "patch_bag"]) as reader:
        assert {one.topic: one.msgcount for one in reader.connections} == counts
        assert all(TOPICS[one.topic][0] == one.msgtype for one in reader.connections)
        poses = [c for c in reader.connections if c.topic == "/odometry"]
        message = reader.deserialize(next(reader.messages(poses))[2], "nav_msgs/msg/Odometry")
    assert (message.header.frame_id, message.child_frame_id) == ("odom", "base_link")
    assert (message.pose.pose.position.x, message.pose.pose.position.z) == pytest.approx((2.0, 1.0))
    assert not list(tmp_path.glob(".*"))


def test_an_mcap_file_is_read_by_the_readers_of_mcap(mcap_file, survey_run):
    make_reader = pytest.importorskip("mcap.reader").make_reader
    factory = pytest.importorskip("mcap_ros2.decoder").DecoderFactory
    oysters = transforms = None
    with open(mcap_file, "rb") as stream:
        for _, channel, _, message in make_reader(stream, decoder_factories=[factory()]).iter_decoded_messages():
            if channel.topic == "/oysters":
                oysters = np.array(message.data).reshape(message.info.height, message.info.width)
            elif channel.topic == "/tf":
                transforms = [(one.header.frame_id, one.child_frame_id) for one in message.transforms]
                shift = message.transforms[0].transform.translation.x
    assert transforms == [("map", "odom"), ("odom", "base_link")]
    assert shift == pytest.approx(-0.4)  # 41 pictures, 1 cm of drift each, none at the start
    from coral.reef.recordings.recording import map_of

    np.testing.assert_array_equal(oysters == 100, map_of(read_run(survey_run).located()).target)


def test_what_is_there_is_not_overwritten(mcap_file, survey_run):
    with pytest.raises(InputError, match="something that exists already"):
        write_bag(read_run(survey_run).located(), mcap_file, single_file=True)
