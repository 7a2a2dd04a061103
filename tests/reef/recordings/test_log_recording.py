"""Pictures beside an autopilot's log."""

import gc
import math

import numpy as np
import pytest

pytest.importorskip("pymavlink")

from autopilot_logs import START_S, dataflash, dataflash_dive, message, telemetry, telemetry_dive
from given_eyes import FlatEyes

from coral.drawing import jpeg
from coral.errors import InputError
from coral.reef.recordings.find_recording import find_recording
from coral.reef.recordings.recorded_pictures import PicturePerception
from coral.view.mp4 import write_mp4

CAMERA = "width: 8\nheight: 6\nhfov_deg: 90\n"


def dive(folder, log="dive.tlog", content=None, camera=CAMERA + "altitude_m: 1.2\n"):
    """Write a log and pictures 0.5, 1.1 and 9 s after the time START_S."""
    made = telemetry_dive() if log.endswith("tlog") else dataflash_dive()
    (folder / log).write_bytes(made if content is None else content)
    (folder / "camera.yaml").write_text(camera)
    for after in (0.5, 1.1, 9.0):
        (folder / f"{START_S + after}.jpg").write_bytes(jpeg(np.zeros((6, 8, 3), np.uint8)))
    return folder


def read(path, **flags):
    return find_recording(path, perception=PicturePerception(FlatEyes(), "flat"), **flags)


def test_pictures_get_the_poses_of_the_log(tmp_path):
    found = read(dive(tmp_path))
    frames = list(found.keyframes())
    assert [frame.t - START_S for frame in frames] == pytest.approx([0.5, 1.1])
    assert frames[1].pose == pytest.approx((3.0, 0.55, math.pi / 4), abs=1e-5)
    assert (frames[1].height_m, frames[1].pitch) == pytest.approx((1.2, math.radians(10.0)), abs=1e-5)
    assert found.omitted == {START_S + 9.0}
    assert found.datum is None
    assert found.remarks == (
        "dive.tlog: first picture at 1683220600.5 s of the log's clock, 0.5 s after its first position",
    )


def test_a_bin_that_counts_from_its_start_needs_to_know_when_the_first_picture_was_taken(tmp_path):
    dive(tmp_path, "dive.BIN")
    with pytest.raises(InputError) as caught:
        read(tmp_path)
    assert str(caught.value) == (
        f"{tmp_path}/dive.BIN: time: found poses from 100.0 to 104.0 s, pictures (names) from 2023-05-04 17:16:40 UTC "
        "(1683220600.5 s) to 2023-05-04 17:16:49 UTC (1683220609.0 s), by clocks that cannot be compared, expected "
        "--pictures-start-s T, the log's time of the first picture"
    )
    frames = list(read(tmp_path / "dive.BIN", pictures_start_s=102.0).keyframes())
    assert [frame.pose.y for frame in frames] == pytest.approx([1.0, 1.3])


def test_a_place_on_earth_comes_with_the_poses(tmp_path):
    place = message("global_position_int", lat=480000000, lon=90000000)
    found = read(dive(tmp_path, content=telemetry_dive() + telemetry((0.0, 1, 1, place), (0.5, 1, 1, place))))
    assert found.datum == pytest.approx((48.0, 9.0))


def test_a_video_lasts_as_long_as_its_recording(tmp_path):
    (tmp_path / "dive.tlog").write_bytes(telemetry_dive())
    (tmp_path / "camera.yaml").write_text("width: 64\nheight: 48\naltitude_m: 1\n")
    write_mp4(tmp_path / "dive.mp4", (np.zeros((48, 64, 3), np.uint8) for _ in range(30)), (64, 48), 10.0)
    found = read(tmp_path, pictures_start_s=START_S + 2.0, period_s=0.5).located()
    gc.collect()
    assert [frame.t - START_S for frame in found.keyframes()] == pytest.approx([2.0, 2.5, 3.0, 3.5])


@pytest.mark.parametrize(
    ("flags", "change", "said"),
    [
        ({"pictures_start_s": START_S + 60.0}, {}, "pictures (names) from 2023-05-04 17:17:40 UTC"),
        (
            {},
            {"camera": CAMERA},
            "height above the sea floor: found no range finder, expected altitude_m in the camera",
        ),
        ({}, {"log": "b.BIN", "content": dataflash()}, "position: found no messages"),
        ({}, {"log": "b.tlog", "content": b"x"}, "position: found no messages"),
    ],
)
def test_what_cannot_be_placed_is_one_line(tmp_path, flags, change, said):
    dive(tmp_path, **change)
    with pytest.raises(InputError) as caught:
        read(tmp_path, **flags)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_pictures_in_a_pause_of_the_log_only_are_refused(tmp_path):
    late = message("local_position_ned")
    content = telemetry(*((t, 1, 1, one) for t in (-9.0, 19.0) for one in (late, message("attitude"))))
    with pytest.raises(InputError, match="found no poses near the pictures"):
        read(dive(tmp_path, content=content))


def test_one_of_several_logs_has_to_be_named(tmp_path):
    dive(dive(tmp_path), "dive.BIN")
    with pytest.raises(
        InputError, match=r"found logs dive\.BIN, dive\.tlog, expected one of them: coral reef map .*BIN"
    ):
        read(tmp_path)
    assert len(list(read(tmp_path / "dive.tlog").keyframes())) == 2


def test_a_time_of_the_log_without_a_log_is_refused(tmp_path):
    (tmp_path / "poses.csv").write_text("t,x,y,yaw\n")
    with pytest.raises(InputError, match=r"--pictures-start-s: found 1\.0, expected an autopilot's log"):
        read(tmp_path, pictures_start_s=1.0)
