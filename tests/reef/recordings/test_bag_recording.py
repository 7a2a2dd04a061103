"""Bags and MCAP files become maps."""

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.camera import CameraCfg
from coral.reef.recordings.bag_export import write_bag
from coral.reef.recordings.bag_reader import is_bag
from coral.reef.recordings.bag_recording import BagTopics, read_bag
from coral.reef.recordings.recorded_camera import RecordedCamera
from coral.reef.recordings.recording import map_of
from coral.reef.recordings.run_recording import read_run

pytest.importorskip("rosbags")


@pytest.fixture(scope="module")
def bags(survey_run, tmp_path_factory):
    folder = tmp_path_factory.mktemp("bags")
    recording = read_run(survey_run).located()
    write_bag(recording, folder / "patch.mcap", single_file=True)
    write_bag(recording, folder / "patch_bag", single_file=False)
    return folder


@pytest.mark.parametrize("name", ["patch.mcap", "patch_bag"])
def test_a_round_trip_gives_the_same_map(bags, survey_run, name):
    there, back = read_run(survey_run).located(), read_bag(bags / name, BagTopics()).located()
    assert is_bag(bags / name)
    assert back.camera == there.camera
    assert back.size_m == there.size_m
    np.testing.assert_array_equal(map_of(back).cells(), map_of(there).cells())
    ours, theirs = list(there.keyframes()), list(back.keyframes())
    assert [one.t for one in ours] == pytest.approx([one.t for one in theirs])
    # Odometry drifts by 1 cm a picture; the transform map -> odom takes it back.
    np.testing.assert_allclose([one.pose for one in theirs], [one.pose for one in ours], atol=1e-9)
    np.testing.assert_allclose(theirs[-1].odometry, ours[-1].odometry, atol=1e-9)


def test_a_given_camera_wins(bags):
    camera = CameraCfg(width=80, height=60, hfov_deg=100.0)
    assert read_bag(bags / "patch.mcap", BagTopics(), RecordedCamera.plain(camera)).camera == camera


@pytest.mark.parametrize(
    ("topics", "said"),
    [
        (BagTopics(odometry="/odom"), "/odom: found no messages, expected nav_msgs/Odometry.*has /camera"),
        (BagTopics(classes="/none"), "found no pictures"),
        (BagTopics(camera_info="/none"), "--camera FILE.yaml"),
    ],
)
def test_what_is_missing_is_named_with_what_there_is(bags, topics, said):
    with pytest.raises(InputError, match=said):
        read_bag(bags / "patch.mcap", topics)


def test_a_damaged_file_is_told_in_one_line(bags, tmp_path):
    (tmp_path / "text.mcap").write_text("this is no recording\n")
    cut = tmp_path / "cut.mcap"
    cut.write_bytes((bags / "patch.mcap").read_bytes()[:20_000])
    for path in (tmp_path / "text.mcap", cut):
        with pytest.raises(InputError, match=path.name) as told:
            list(read_bag(path, BagTopics()).keyframes())
        assert "\n" not in str(told.value)
