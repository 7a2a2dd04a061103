"""The offset of a video's clock, by its turns."""

import math

import cv2
import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.recordings.clock_offset import STEP_S, find_offset, shifts
from coral.reef.recordings.find_recording import find_recording
from coral.reef.recordings.perception import PicturePerception
from coral.reef.recordings.pose_track import StampedTransforms
from coral.reef.recordings.transforms import body_transform
from coral.reef.world.geometry import Pose, wrap
from coral.view.mp4 import write_mp4

RATE = 10
"""Of the made-up yaw and of the videos (Hz)."""


def dive(seconds, seed=3):
    """Return the yaw of a vehicle that turns at random (rad), `RATE` a second."""
    rng = np.random.default_rng(seed)
    rates = np.zeros(seconds * RATE)
    for k in range(1, len(rates)):
        rates[k] = 0.95 * rates[k - 1] + 0.05 * rng.normal()
    return np.cumsum(rates) / RATE


def track(yaw, begin=1000.0):
    found = StampedTransforms(gap_s=1.5)
    for k, one in enumerate(yaw):
        found.add(begin + k / RATE, body_transform(Pose(0.0, 0.0, wrap(float(one))), 0.0, 0.0, 0.0))
    return found


def pictures(yaw, width=160, height=120):
    """Yield what a camera with 90 degrees sees of far things as it turns; grains of noise in each picture."""
    rng = np.random.default_rng(0)
    around = cv2.GaussianBlur(rng.integers(0, 255, (height, 3000, 3), np.uint8), (0, 0), 2.0)
    around = cv2.normalize(around, None, 0, 255, cv2.NORM_MINMAX)
    for one in yaw:
        left = round(1400 - one * width / 2)
        seen = around[:, left : left + width].astype(np.int16) + rng.integers(-20, 20, (height, width, 1))
        yield np.clip(seen, 0, 255).astype(np.uint8)


def test_small_pictures_tell_turns_to_the_left_as_shifts_to_the_right():
    yaw = np.linspace(0.0, 0.5, 11)
    small = np.array([cv2.cvtColor(one, cv2.COLOR_RGB2GRAY) for one in pictures(yaw)])
    assert shifts(small) == pytest.approx(np.full(10, 0.05 * 80), abs=0.6)  # focal length: 80 px


def test_turns_fit_where_they_were_made_and_nowhere_else():
    yaw = dive(300)
    turns = np.diff(yaw[::2]) / STEP_S
    noise = 0.5 * np.random.default_rng(1).normal(size=turns.size) * turns.std()
    found = find_offset((turns + noise)[400:900], track(yaw))
    assert found.is_clear
    assert found.start_s == pytest.approx(1080.0, abs=0.2)
    assert not find_offset((turns + noise)[400:900], track(dive(300, seed=4))).is_clear


def test_even_legs_fit_at_several_places_and_are_no_answer():
    legs = np.cumsum(np.where(np.arange(3000) % 300 < 40, 0.04, 0.0) * np.where(np.arange(3000) % 600 < 300, 1, -1))
    found = find_offset(np.diff(legs[::2])[300:900], track(legs))
    assert found.best > 0.9
    assert not found.is_clear


def test_without_turns_there_is_no_offset():
    assert find_offset(np.zeros(300), track(dive(100))) is None
    assert find_offset(np.diff(dive(100)[::2]), track(np.zeros(1000))) is None
    assert find_offset(np.diff(dive(10)[::2]), track(dive(100))) is None


class TestVideo:
    @pytest.fixture
    def folder(self, tmp_path):
        pytest.importorskip("pymavlink")
        pytest.importorskip("imageio_ffmpeg")
        from autopilot_logs import message, telemetry

        rows = []
        for k, one in enumerate(dive(120)):
            rows.append((k / RATE, 1, 1, message("attitude", yaw=wrap(math.pi / 2 - float(one)))))
            rows.append((k / RATE, 1, 1, message("local_position_ned", x=0.01 * k)))
        (tmp_path / "dive.tlog").write_bytes(telemetry(*rows))
        (tmp_path / "camera.yaml").write_text("width: 160\nheight: 120\nhfov_deg: 90\naltitude_m: 1\n")
        return tmp_path

    def read(self, folder):
        from given_eyes import FlatEyes

        return find_recording(folder, perception=PicturePerception(FlatEyes(), "flat"), period_s=5.0)

    def test_a_video_of_unknown_time_is_placed_by_its_turns(self, folder):
        from autopilot_logs import START_S

        write_mp4(folder / "dive.mp4", pictures(dive(120)[314:914]), (160, 120), float(RATE))
        found = self.read(folder)
        assert next(found.keyframes()).t - START_S == pytest.approx(31.4, abs=0.2)
        assert "estimated: the video begins at" in found.remarks[0]
        assert "elsewhere up to 0." in found.remarks[0]
        assert "--pictures-start-s T gives another time" in found.remarks[0]

    def test_a_video_that_never_turns_is_refused(self, folder):
        write_mp4(folder / "dive.mp4", pictures(np.zeros(600)), (160, 120), float(RATE))
        with pytest.raises(
            InputError, match=r"by clocks that cannot be compared.*expected --pictures-start-s T"
        ) as told:
            self.read(folder)
        assert "\n" not in str(told.value)
