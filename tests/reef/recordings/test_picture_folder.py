"""A folder of pictures with poses.csv."""

import math

import numpy as np
import pytest
from given_eyes import FlatEyes
from survey_runs import write_run

from coral.drawing import jpeg
from coral.errors import InputError
from coral.reef.recordings.find_recording import find_recording
from coral.reef.recordings.picture_folder import export_pictures, read_folder
from coral.reef.recordings.recorded_pictures import PicturePerception
from coral.reef.recordings.run_recording import read_run
from coral.reef.sea.recorded_camera import RecordedCamera
from coral.reef.vehicle.camera import CameraCfg

CAMERA = RecordedCamera.plain(CameraCfg(width=4, height=3))


def folder(tmp_path, text):
    (tmp_path / "poses.csv").write_text(text)
    return tmp_path


def test_pictures_and_poses_of_a_run_are_such_a_folder(survey_run):
    frames = list(read_folder(survey_run / "frames", RecordedCamera.plain(CameraCfg(width=80, height=60))).keyframes())
    assert len(frames) == 41
    assert frames[0].pose == pytest.approx((2.0, 2.0, 0.5))
    assert frames[1].t == 0.5
    assert frames[1].odometry.x == pytest.approx(frames[1].pose.x + 0.01)
    assert (frames[5].frame.labels == 1).any()
    assert np.isfinite(frames[5].frame.depth).any()


def test_degrees_become_metres_east_and_north_and_a_heading_an_angle(tmp_path):
    path = folder(tmp_path, "t,lat,lon,heading,rgb\n0,45.0,9.0,0,a.jpg\n60,45.001,9.001,90,a.jpg\n")
    (path / "a.jpg").write_bytes(jpeg(np.zeros((3, 4, 3), np.uint8)))
    recording = read_folder(path, CAMERA, PicturePerception(FlatEyes(), "flat"))
    first, second = (one.pose for one in recording.keyframes())
    assert first == pytest.approx((0.0, 0.0, math.pi / 2), abs=1e-6)
    # A degree at 45 north: 111 132 m along the meridian, 78 847 m along the parallel (WGS 84).
    assert second == pytest.approx((78.847, 111.132, 0.0), abs=0.01)
    assert recording.datum == (45.0, 9.0)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("t,x\n0,1\n", "expected columns t, x, y, yaw"),
        ("t,lat,lon\n0,1,2\n", "heading: found columns t, lat, lon without heading, expected the compass heading"),
        ("t,x,y\n0,1,2\n", "yaw: found columns t, x, y without yaw, expected the direction of the camera"),
        ("t;x;y;yaw\n0;4,4;2;0\n", "x: found '4,4', expected a decimal point, as in 4.4, not a decimal comma"),
        ("t,x,y,yaw\n", "found no rows"),
        ("t,x,y,yaw\n0,1,2\n", "line 2: found 3 fields, expected 4"),
        ("t,x,y,yaw\n0,1,2,north\n", "line 2: yaw: found 'north', expected a number"),
        ("t,x,y,yaw\n1,1,2,0\n0,1,2,0\n", "line 3: t: found 0, expected times that never go back"),
        ("t,lat,lon,heading\n0,100,9,0\n", "lat, lon: found 100, 9"),
        ("t,lat,lon,heading\n0,36.95,-122.02,0\n1,0,0,0\n", "line 3: lat, lon: found 0, 0, a receiver without a fix"),
        ("t,lat,lon,heading\n0,0,0,0\n1,36.95,-122.02,0\n", "line 2: lat, lon: found 0, 0, a receiver without a fix"),
        (
            "t,lat,lon,heading\n0,36.95,9,0\n0.5,36.952,9,0\n",
            "line 3: lat, lon: found 222 m from the line before it",
        ),
        ("t,x,y,yaw\n0,1,2,0\n2,1,73,0\n", "line 3: x, y: found 71 m from the line before it, 2 s later"),
        ("t,x,y,yaw\n0,nan,2,0\n", "line 2: x: found 'nan', expected a number"),
        ("t,x,y,yaw,z\n0,1,2,0,-3\n", "line 2: z: found -3, expected a height above the sea floor"),
    ],
)
def test_a_bad_table_is_told_in_one_line(tmp_path, text, said):
    with pytest.raises(InputError, match=said):
        read_folder(folder(tmp_path, text), CAMERA)


def test_the_line_that_a_killed_run_was_writing_is_left_out(tmp_path):
    path = folder(tmp_path, "t,x,y,yaw,rgb\n0,1,2,0,a.jpg\n1,1,2")
    assert read_folder(path, CAMERA).start == (1.0, 2.0, 0.0)


def test_a_picture_that_is_missing_is_named(tmp_path):
    path = folder(tmp_path, "t,x,y,yaw,labels,depth\n0,1,2,0,a.png,b.png\n")
    with pytest.raises(InputError, match=r"line 2: labels: found a\.png"):
        list(read_folder(path, CAMERA).keyframes())


def test_colour_alone_needs_eyes(tmp_path):
    path = folder(tmp_path, "t,x,y,yaw,rgb\n0,1,2,0,a.jpg\n")
    (path / "a.jpg").write_bytes(jpeg(np.zeros((3, 4, 3), np.uint8)))
    with pytest.raises(InputError, match="found colour pictures only, expected --perception rgb, painted"):
        list(read_folder(path, CAMERA).keyframes())


def test_eyes_see_colour_pictures_even_where_the_folder_has_classes(survey_run, tmp_path):
    path = folder(tmp_path, "t,x,y,z,yaw,pitch,labels,depth,rgb\n0,1,2,0.7,0,0.1,gone.png,gone.png,a.jpg\n")
    (path / "a.jpg").write_bytes(jpeg(np.full((3, 4, 3), 90, np.uint8)))
    eyes = FlatEyes()
    (one,) = read_folder(path, CAMERA, PicturePerception(eyes, "flat")).keyframes()
    assert (one.frame.labels == 3).all()
    assert (eyes.attitude.height, eyes.attitude.pitch) == (0.7, 0.1)


def test_pictures_closer_in_time_than_the_period_are_passed_over(survey_run):
    camera = RecordedCamera.plain(CameraCfg(width=80, height=60))
    times = [one.t for one in read_folder(survey_run / "frames", camera, period_s=1.2).keyframes()]
    assert times[:3] == [0.0, 1.5, 3.0]


def test_poses_camera_and_colours_come_back(tmp_path):
    write_run(tmp_path / "patch-001", colour=True)
    there = read_run(tmp_path / "patch-001").located()
    assert export_pictures(there, tmp_path / "out") == {"pictures": 41}
    assert {path.suffix for path in (tmp_path / "out").iterdir()} == {".csv", ".yaml", ".jpg"}
    back = find_recording(tmp_path / "out", perception=PicturePerception(FlatEyes(), "flat"))
    assert back.camera == there.camera
    for mine, theirs in zip(back.keyframes(), there.keyframes(), strict=True):
        assert mine.t == theirs.t
        assert mine.pose == pytest.approx(theirs.pose, abs=1e-7)
        assert np.abs(mine.frame.rgb.astype(int) - theirs.frame.rgb).mean() < 3  # a JPEG of a JPEG


def test_a_run_without_colours_has_nothing_to_write(survey_run, tmp_path):
    with pytest.raises(InputError, match=r"no colour picture at 0 s, expected a run with --cfg\.simulator\.pictures"):
        export_pictures(read_run(survey_run).located(), tmp_path / "out")
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "out").mkdir()
    with pytest.raises(InputError, match="something that exists already"):
        export_pictures(read_run(survey_run).located(), tmp_path / "out")
