"""What a measurement must satisfy."""

import dataclasses
import math

import numpy as np
import pytest

from coral.reef.pilot import checks
from coral.reef.pilot.checks import UnfitMeasurement, finite_numbers
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.vehicle.sensing import Stamped
from coral.reef.world.geometry import Frame, Label, Pose

CAMERA = CameraCfg(width=8, height=6)


def picture(depth=5.0, label=Label.SEABED, shape=(6, 8)):
    return Frame(np.full(shape, depth, np.float32), np.full(shape, label, np.uint8), np.full(shape, -1, np.int32))


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        ((1.0, 2.0), "wrong size"),
        ((1.0, math.nan, 0.0), "not finite"),
        ((1.0, math.inf, 0.0), "not finite"),
        (None, "wrong type"),
        ("abc", "wrong type"),
        ((1.0, None, 2.0), "wrong type"),
        ((10**400, 0, 0), "wrong type"),
    ],
)
def test_what_is_not_three_finite_numbers_is_named(value, reason):
    with pytest.raises(UnfitMeasurement) as fault:
        finite_numbers(value, 3)
    assert fault.value.reason == reason


def reason_of(check, *args):
    with pytest.raises(UnfitMeasurement) as fault:
        check(*args)
    return fault.value.reason


def test_a_vehicle_faster_than_any_is_not_believed():
    checks.check_velocity((1.4, 0.0, -1.9), 1.5, 2.0)
    assert reason_of(checks.check_velocity, (1.2, 1.2, 0.0), 1.5, 2.0) == "too fast"
    assert reason_of(checks.check_velocity, (0.0, 0.0, -2.1), 1.5, 2.0) == "too fast"


def test_a_pose_far_outside_of_the_survey_area_is_refused():
    checks.check_area(Pose(-1.0, 31.0, 0.0), (20.0, 30.0), 2.0)
    assert reason_of(checks.check_area, Pose(-2.1, 0.0, 0.0), (20.0, 30.0), 2.0) == "outside"
    assert reason_of(checks.check_area, Pose(0.0, 32.1, 0.0), (20.0, 30.0), 2.0) == "outside"


def test_a_jump_is_one_of_place_or_of_heading_over_the_seam_too():
    checks.check_jump(Pose(0, 0, 3.1), Pose(0.3, 0.4, -3.1), 0.5, 0.1)
    assert reason_of(checks.check_jump, Pose(0, 0, 0), Pose(0.4, 0.4, 0), 0.5, 0.1) == "jumped"
    assert reason_of(checks.check_jump, Pose(0, 0, 0), Pose(0, 0, 0.2), 0.5, 0.1) == "jumped"


def test_an_uncertain_position_is_refused():
    checks.check_covariance(np.diag([1.0, 3.9, 9.0]), 2.0)
    assert reason_of(checks.check_covariance, np.diag([1.0, 4.1, 0.0]), 2.0) == "uncertain"
    assert reason_of(checks.check_covariance, np.eye(2), 2.0) == "wrong size"
    assert reason_of(checks.check_covariance, np.full((3, 3), math.nan), 2.0) == "not finite"
    assert reason_of(checks.check_covariance, np.diag([-1.0, 1.0, 1.0]), 2.0) == "not finite"
    assert reason_of(checks.check_covariance, "no matrix", 2.0) == "wrong type"


def test_a_vehicle_on_its_side_or_in_the_air_is_not_believed():
    checks.check_attitude(0.1, -0.7, -0.2, 0.8)
    assert reason_of(checks.check_attitude, 0.0, -0.9, 1.0, 0.8) == "too far tilted"
    assert reason_of(checks.check_attitude, 0.0, 0.0, -1.0, 0.8) == "negative depth"


BAD = picture()
BAD.depth[2, 3] = -0.1


@pytest.mark.parametrize(
    ("frame", "reason"),
    [
        (None, "wrong type"),
        (dataclasses.replace(picture(), depth=None), "wrong type"),
        (dataclasses.replace(picture(), depth=np.full((6, 8), 5.0)), "wrong type"),
        (dataclasses.replace(picture(), labels=np.full((6, 8), 3, np.int32)), "wrong type"),
        (picture(shape=(480, 640)), "wrong size"),
        (picture(shape=(8, 6)), "wrong size"),
        (dataclasses.replace(picture(), labels=np.zeros((6, 9), np.uint8)), "wrong size"),
        (dataclasses.replace(picture(), depth=np.zeros((6, 8, 3), np.float32)), "wrong size"),
        (picture(label=4), "unknown label"),
        (BAD, "not positive"),
        (picture(depth=0.0), "not positive"),
        (picture(depth=-math.inf), "not positive"),
        (picture(depth=math.inf), "blind"),
        (picture(depth=math.nan), "blind"),
    ],
)
def test_a_picture_that_the_map_cannot_take_is_named(frame, reason):
    assert reason_of(checks.check_frame, frame, CAMERA, 0.05) == reason


def test_a_good_picture_may_have_pixels_without_return():
    frame = picture(depth=math.nan)
    frame.depth[0, :3] = 2.0
    assert checks.check_frame(frame, CAMERA, 0.05) is frame
    assert checks.picture_key(frame) == checks.picture_key(dataclasses.replace(frame, depth=frame.depth.copy()))
    assert checks.picture_key(frame) != checks.picture_key(picture())


COLOURS = np.random.default_rng(0).integers(90, 120, (6, 8, 3), np.uint8)
TITLED = np.zeros((80, 120, 3), np.uint8)
TITLED[4:8, 4:8] = 255  # a spot of a title, 1 of 600 pixels


@pytest.mark.parametrize(
    ("rgb", "reason"),
    [(TITLED, "black"), (np.full((6, 8, 3), 255, np.uint8), "plain"), (COLOURS // 100 + 70, "plain")],
)
def test_a_picture_of_one_colour_is_named_whatever_eyes_make_of_it(rgb, reason):
    camera = dataclasses.replace(CAMERA, width=rgb.shape[1], height=rgb.shape[0])
    frame = dataclasses.replace(picture(shape=rgb.shape[:2]), rgb=rgb)
    assert reason_of(checks.check_frame, frame, camera, 0.05) == reason


def test_the_same_colours_are_the_same_picture_whatever_eyes_make_of_it():
    one, other = (dataclasses.replace(picture(depth=depth), rgb=COLOURS) for depth in (5.0, 5.1))
    assert checks.picture_key(one) == checks.picture_key(other)
    assert checks.has_landmarks(one)


def test_bare_seabed_may_look_the_same_everywhere():
    assert not checks.has_landmarks(picture())
    for label in (Label.OYSTER, Label.OBSTACLE):
        assert checks.has_landmarks(picture(label=label))


def hangs(measured, velocity):
    sensor = checks.FrozenSensor(ord, way_m=0.05, turn_rad=0.05)
    return [sensor.update(Stamped(k / 10, one), velocity) for k, one in enumerate(measured)]


def test_the_same_again_from_a_moving_vehicle_is_frozen():
    assert hangs("aaaa", (0.3, 0.0, 0.0)) == ["", "", "frozen", "frozen"]
    assert hangs("aaaa", (0.0, 0.3, 0.0)) == ["", "", "frozen", "frozen"]
    assert hangs("aaaa", (0.0, 0.0, -0.3)) == ["", "", "frozen", "frozen"]


def test_a_standing_vehicle_sees_the_same_again():
    assert not any(hangs("a" * 50, (0.0, 0.0, 0.0)))


def test_something_new_ends_it():
    assert hangs("aaaabb", (0.3, 0.0, 0.0)) == ["", "", "frozen", "frozen", "", ""]


def test_a_stream_that_plays_a_piece_again_and_again_is_named():
    assert hangs("abcabcd", (0.3, 0.0, 0.0)) == ["", "", "", "repeated", "repeated", "repeated", ""]
    assert not any(hangs("abcabc", (0.0, 0.0, 0.0)))
