"""Keyframes, their area, and the map made from them."""

import numpy as np
import pytest

from coral.errors import InputError
from coral.foreign_file import read_picture_file
from coral.reef.recordings.recording import PosedFrame, Recording, map_of
from coral.reef.recordings.run_recording import read_run
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Frame, Pose

CAMERA = CameraCfg(width=8, height=6)
FRAME = Frame(np.full((6, 8), 2.0, np.float32), np.full((6, 8), 3, np.uint8), np.full((6, 8), -1, np.int32))


def recording(*poses):
    frames = [PosedFrame(t=float(k), pose=pose, height_m=1.0, frame=FRAME) for k, pose in enumerate(poses)]
    return Recording(name="r", source="r", camera=CAMERA, keyframes=lambda: iter(frames))


def test_without_an_area_the_map_reaches_beyond_all_poses_in_whole_cells():
    located = recording(Pose(-3.01, 10.0, 0.2), Pose(1.0, 12.0, 0.0)).located()
    first, second = (frame.pose for frame in located.keyframes())
    assert (second.x - first.x, second.y - first.y) == pytest.approx((4.01, 2.0))
    assert first.x == pytest.approx(6.54)
    assert first.y == pytest.approx(6.5)
    assert located.size_m == pytest.approx((17.05, 15.0))
    assert located.start == first


def test_an_area_as_large_as_a_bay_is_refused():
    with pytest.raises(InputError, match="a survey of at most 500 m"):
        recording(Pose(0, 0, 0), Pose(5000.0, 0, 0)).located()


def test_a_recording_without_pictures_is_refused():
    with pytest.raises(InputError, match="at least one"):
        recording().located()


def test_the_map_of_keyframes_is_that_of_their_pictures(survey_run):
    made = map_of(read_run(survey_run).located())
    assert made.target.sum() > 200
    # Depth was kept in millimetres: a few cells at edges differ from the map of the exact pictures.
    final = read_picture_file(max((survey_run / "frames").glob("*_map.png")), channels=1) == 3
    shared = (final & made.target).sum() / (final | made.target).sum()
    assert shared > 0.9


def test_roll_and_pitch_reach_the_map(survey_run):
    from dataclasses import replace

    from coral.reef.recordings.run_recording import read_run

    level = read_run(survey_run).located()

    def nose_down():
        return (replace(one, pitch=0.2) for one in level.keyframes())

    there = map_of(replace(level, keyframes=nose_down))
    assert (there.target != map_of(level).target).mean() > 0.002
