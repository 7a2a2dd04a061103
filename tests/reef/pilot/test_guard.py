"""The guard of the sensors, fed with observations made by hand."""

import dataclasses
import math

import numpy as np
import pytest
from garbage import observations
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from coral.reef.map.sonar_3d15 import SonarCfg
from coral.reef.pilot.guard import GuardCfg, SensorGuard
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.vehicle.range_image import RangeImage
from coral.reef.vehicle.sensing import Attitude, Stamped, VehicleObservation
from coral.reef.world.geometry import Frame, Label, Pose

CAMERA = CameraCfg(width=8, height=6)
SONAR = SonarCfg(enabled=True, width=8, height=4)
STILL = (0.0, 0.0, 0.0)


def picture(label=Label.SEABED, depth=5.0):
    shape = (CAMERA.height, CAMERA.width)
    return Frame(np.full(shape, depth, np.float32), np.full(shape, label, np.uint8), np.full(shape, -1, np.int32))


def good(t, x=5.0, **changes):
    return dataclasses.replace(VehicleObservation.at(t, Pose(x, 5.0, 0.0), STILL, picture()), **changes)


def guard(**cfg):
    return SensorGuard(CAMERA, (20.0, 20.0), GuardCfg(**cfg))


def refusals(reading):
    return [(refusal.input, refusal.reason) for refusal in reading.refusals]


def test_what_is_good_passes_as_it_is():
    seen = good(0.3)
    reading = guard().check(seen)
    assert (reading.t, reading.pose, reading.velocity) == (0.3, Pose(5.0, 5.0, 0.0), STILL)
    assert reading.frame is seen.frame.value
    assert reading.frame_pose == reading.pose
    assert (reading.refusals, reading.lost) == ((), "")


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"pose": Stamped(1.0, Pose(math.nan, 0, 0))}, ("pose", "not finite")),
        ({"pose": Stamped(1.0, Pose(9.0, 5.0, 0))}, ("pose", "jumped")),
        ({"pose": Stamped(1.0, Pose(90.0, 5.0, 0))}, ("pose", "outside")),
        ({"pose": Stamped(0.2, Pose(5.0, 5.0, 0))}, ("pose", "stale")),
        ({"pose": Stamped(0.8, Pose(5.0, 5.0, 0))}, ("pose", "out of order")),
        ({"pose": Stamped(1.2, Pose(5.0, 5.0, 0))}, ("pose", "from the future")),
        ({"pose": Stamped(math.nan, Pose(5.0, 5.0, 0))}, ("pose", "not finite")),
        ({"pose": Pose(5.0, 5.0, 0)}, ("pose", "wrong type")),
        ({"covariance": np.diag([9.0, 0.0, 0.0])}, ("pose", "uncertain")),
        ({"velocity": Stamped(1.0, (0.0, math.inf, 0.0))}, ("velocity", "not finite")),
        ({"velocity": Stamped(1.0, (5.0, 0.0, 0.0))}, ("velocity", "too fast")),
        ({"frame": Stamped(1.0, picture(depth=math.inf))}, ("camera", "blind")),
        ({"frame": Stamped(0.5, picture())}, ("camera", "stale")),
        ({"attitude": Stamped(1.0, Attitude(roll=1.5, pitch=0.0, depth_m=2.0))}, ("attitude", "too far tilted")),
        ({"attitude": Stamped(1.0, "level")}, ("attitude", "wrong type")),
        ({"t": -5.0}, ("clock", "jumped")),
        ({"t": math.nan}, ("clock", "not finite")),
    ],
)
def test_what_is_wrong_is_refused_by_name_and_the_last_good_one_is_used(changes, expected):
    watch = guard()
    watch.check(good(0.9))
    reading = watch.check(dataclasses.replace(good(1.0), **changes))
    assert expected in refusals(reading)
    assert reading.lost == ""
    assert reading.pose == pytest.approx((5.0, 5.0, 0.0))
    assert reading.t > 0.9


def test_an_input_slower_than_the_loop_is_no_fault():
    watch, first = guard(), good(0.0)
    watch.check(first)
    for t in (0.1, 0.2, 0.3):
        reading = watch.check(dataclasses.replace(first, t=t))
        assert (reading.refusals, reading.lost, reading.frame) == ((), "", None)


def test_what_is_missing_too_long_is_lost_and_back_with_the_next_good_one():
    watch = guard(frame_timeout_s=0.4)
    watch.check(good(0.0))
    lost = {k: watch.check(good(k / 10, frame=None)).lost for k in range(1, 7)}
    assert [k for k, why in lost.items() if why] == [5, 6]  # 0.4 s is not more than 0.4 s
    assert lost[5] == "camera missing, for 0.5 s"
    assert watch.check(good(0.7)).lost == ""


def test_before_the_first_measurements_all_are_lost():
    reading = guard().check(VehicleObservation(t=0.0))
    assert reading.lost == "pose missing; velocity missing; camera missing"
    assert reading.pose is None


def test_a_picture_without_a_known_pose_is_not_used():
    assert guard().check(good(0.0, pose=None)).frame is None


def test_a_lasting_jump_is_not_believed_until_a_person_says_so():
    watch = guard()
    watch.check(good(0.0))
    readings = [watch.check(good(k / 10, x=9.0)) for k in range(1, 100)]
    assert all(refusals(reading) == [("pose", "jumped")] for reading in readings)
    watch.relocate()
    assert watch.check(good(10.0, x=9.0)).pose == Pose(9.0, 5.0, 0.0)


def test_after_a_gap_a_vehicle_may_have_moved_as_far_as_it_can():
    watch = guard(max_speed_m_s=1.0, jump_m=0.5)
    watch.check(good(0.0))
    for k in range(1, 30):
        watch.check(good(k / 10, pose=None))
    assert refusals(watch.check(good(3.0, x=8.4))) == []


def test_a_camera_that_hangs_is_refused():
    watch, same, moving = guard(), picture(Label.OYSTER), (0.3, 0.0, 0.0)
    found = [
        refusals(watch.check(good(k / 10, velocity=Stamped(k / 10, moving), frame=Stamped(k / 10, same))))
        for k in range(4)
    ]
    assert found == [[], [], [("camera", "frozen")], [("camera", "frozen")]]


def test_colours_that_hang_are_refused_whatever_eyes_make_of_them():
    watch, rgb = guard(), np.random.default_rng(0).integers(0, 255, (CAMERA.height, CAMERA.width, 3), np.uint8)
    found = []
    for k in range(4):
        seen = dataclasses.replace(picture(depth=5.0 + 0.01 * k), rgb=rgb)  # its depth follows from the attitude
        moving = Stamped(k / 10, (0.3, 0.0, 0.0))
        found.append(refusals(watch.check(good(k / 10, velocity=moving, frame=Stamped(k / 10, seen)))))
    assert found == [[], [], [("camera", "frozen")], [("camera", "frozen")]]


@pytest.mark.parametrize("by", [-30.0, 30.0])
def test_a_clock_that_was_set_costs_one_tick(by):
    watch = guard()
    for k in range(5):
        watch.check(good(k / 10))
    found = [refusals(watch.check(good(k / 10 + by))) for k in range(5, 10)]
    assert found == [[("clock", "jumped")], [], [], [], []]


def test_a_late_picture_is_put_where_it_was_taken():
    watch = guard()
    for k in range(5):
        watch.check(good(k / 10, x=5 + 0.1 * k, frame=None))
    reading = watch.check(good(0.5, x=5.5, frame=Stamped(0.35, picture())))
    assert reading.frame_pose == pytest.approx((5.35, 5.0, 0.0))
    assert reading.pose == Pose(5.5, 5.0, 0.0)


def test_a_picture_in_another_memory_layout_is_copied_and_not_refused():
    turned = picture()
    turned = dataclasses.replace(turned, depth=np.asfortranarray(turned.depth))
    reading = guard().check(good(0.0, frame=Stamped(0.0, turned)))
    assert reading.frame.depth.flags.c_contiguous


@settings(max_examples=10, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.lists(st.floats(0.0, 3.0), max_size=6).flatmap(lambda ts: st.tuples(*[observations(t, 6, 8) for t in ts])))
def test_no_garbage_raises_and_nothing_that_is_not_finite_passes(garbage):
    watch, last = SensorGuard(CAMERA, (20.0, 20.0), sonar=SONAR), -math.inf
    for seen in garbage:
        reading = watch.check(seen)
        assert reading.t >= last
        last = reading.t
        for value in (reading.pose, reading.velocity, reading.frame_pose):
            assert value is None or np.isfinite(value).all()
        if reading.frame is not None:
            assert reading.frame.depth.shape == (6, 8)
        if reading.sonar is not None:
            assert reading.sonar.ranges.shape == (4, 8)
            assert (reading.sonar.ranges > 0.0).all()


def test_a_picture_comes_with_the_attitude_in_which_it_was_taken():
    watch, level = guard(), Attitude(roll=0.0, pitch=0.0, depth_m=1.0)
    tilted = dataclasses.replace(level, roll=0.2)
    watch.check(good(0.0, attitude=Stamped(0.0, tilted)))
    reading = watch.check(good(0.1, attitude=Stamped(0.1, level), frame=Stamped(0.05, picture(depth=4.0))))
    assert reading.attitude == tilted
    assert watch.check(good(0.2, frame=None)).attitude is None
    assert watch.check(good(0.9)).attitude is None  # too old to be that of the picture


def test_attitudes_follow_a_clock_that_was_set():
    watch = guard(gap_s=1.0)
    for t in (0.0, 0.1):
        watch.check(good(t, attitude=Stamped(t, Attitude(roll=t, pitch=0.0, depth_m=1.0))))
    assert watch.check(good(30.1)).attitude == Attitude(roll=0.1, pitch=0.0, depth_m=1.0)


def echo(t, value=4.0, shape=(4, 8), dtype=np.float32, view=(90.0, 40.0)):
    return Stamped(t, RangeImage(np.full(shape, value, dtype), *view))


def listening(**keys):
    return SensorGuard(CAMERA, (20.0, 20.0), GuardCfg(), SONAR, **keys)


def test_a_range_image_passes_with_the_pose_and_the_attitude_of_its_ping():
    watch, tilted = listening(), Attitude(roll=0.1, pitch=0.0, depth_m=1.0)
    watch.check(good(0.0, x=5.0, attitude=Stamped(0.0, tilted)))
    reading = watch.check(good(0.1, x=5.1, sonar=echo(0.05)))
    assert reading.sonar_pose.x == pytest.approx(5.05)
    assert reading.sonar_attitude == tilted
    assert reading.sonar.ranges[0, 0] == 4.0


@pytest.mark.parametrize(
    ("image", "reason"),
    [
        (echo(1.0, np.inf), "blind"),
        (echo(1.0, np.nan), "not positive"),
        (echo(1.0, -1.0), "not positive"),
        (echo(1.0, shape=(8, 4)), "wrong size"),
        (echo(1.0, dtype=np.float64), "wrong type"),
        (echo(1.0, view=(40.0, 40.0)), "wrong field of view"),
        (echo(1.0, view=(None, 40.0)), "wrong type"),
        (Stamped(1.0, np.ones((4, 8), np.float32)), "wrong type"),
        (echo(0.2), "stale"),
        (echo(1.2), "from the future"),
        (echo(1.0).value, "wrong type"),
    ],
)
def test_a_range_image_that_cannot_be_used_is_refused_by_name(image, reason):
    watch = listening()
    for k in range(10):
        watch.check(good(k / 10, sonar=echo(k / 10)))
    assert refusals(watch.check(good(1.0, sonar=image))) == [("sonar", reason)]


def test_a_sonar_that_hangs_is_noticed_once_the_vehicle_has_moved():
    watch = listening()
    said = [
        refusals(watch.check(good(t, x=5 + t, velocity=Stamped(t, (0.5, 0, 0)), sonar=echo(t))))
        for t in (0.0, 0.1, 0.2, 0.3)
    ]
    assert said == [[], [], [("sonar", "frozen")], [("sonar", "frozen")]]


def blinded(watch, seconds, **changes):
    """Readings of two seconds with everything, then `seconds` without a picture."""
    early = [watch.check(good(k / 10, sonar=echo(k / 10, 4.0 + 0.01 * k))) for k in range(20)]
    late = [
        watch.check(good(k / 10, frame=None, **{"sonar": echo(k / 10, 4.0 + 0.01 * k), **changes}))
        for k in range(20, 20 + round(10 * seconds))
    ]
    return early, late


def test_a_sonar_stands_in_for_the_camera():
    _, late = blinded(listening(), 60.0)
    assert not any(reading.lost for reading in late)
    assert [reading.blind for reading in late[:2]] == ["", ""]
    assert all("camera missing" in reading.blind for reading in late[4:])


def test_without_camera_and_sonar_nothing_moves_and_both_are_named():
    _, late = blinded(listening(), 1.0, sonar=None)
    held = next(k for k, reading in enumerate(late) if reading.lost)
    assert held <= 5
    assert "camera missing" in late[-1].lost
    assert "sonar missing" in late[-1].lost
    assert late[-1].blind == ""


def test_a_start_needs_the_camera():
    watch = listening()
    assert "camera missing" in watch.check(good(0.0, frame=None, sonar=echo(0.0))).lost


def test_where_only_the_sonar_finds_obstacles_nothing_moves_without_it():
    for alone in (False, True):
        watch = listening(sonar_alone=lambda alone=alone: alone)
        for k in range(20):
            watch.check(good(k / 10, sonar=echo(k / 10, 4.0 + 0.01 * k)))
        late = [watch.check(good(k / 10)) for k in range(20, 30)]
        assert ("sonar missing" in late[-1].lost) == alone
        assert "sonar missing" in late[-1].deaf


def test_without_a_sonar_its_images_are_not_looked_at():
    reading = guard().check(good(0.0, sonar="nonsense"))
    assert (reading.sonar, reading.deaf, reading.refusals) == (None, "", ())


def test_the_vehicle_brakes_before_camera_and_sonar_are_lost():
    """Both are 5 Hz here; the camera's last look is at 0.6 s."""

    def overdue(sonar, last_heard):
        watch = SensorGuard(CAMERA, (20.0, 20.0), sonar=sonar)
        found = []
        for k in range(10):
            t = k / 10
            camera, heard = Stamped(min(t, 0.6), picture()), echo(min(t, last_heard), 4.0 + 0.01 * k)
            found.append(watch.check(good(t, frame=camera, sonar=heard)))
        return [round(reading.t, 1) for reading in found if reading.overdue], [reading.lost for reading in found]

    late, lost = overdue(None, 0.0)
    assert late == [0.9]
    assert not any(lost)  # it would be lost at 1.0 s
    assert overdue(SONAR, 0.6)[0] == [0.9]
    assert overdue(SONAR, 0.9)[0] == []
    assert overdue(SONAR, 0.4)[0] == [0.9]


def test_where_the_sonar_alone_finds_obstacles_the_vehicle_brakes_for_it():
    watch = SensorGuard(CAMERA, (20.0, 20.0), sonar=SONAR, sonar_alone=lambda: True)
    late = [watch.check(good(k / 10, sonar=echo(min(k / 10, 0.5), 4.0 + 0.01 * k))).overdue for k in range(9)]
    assert late == [False] * 8 + [True]


def test_the_covariance_of_the_last_pose_is_passed_on():
    watch, told = guard(), np.diag([0.01, 0.02, 0.001])
    assert watch.check(good(0.0)).covariance is None
    assert np.array_equal(watch.check(good(0.1, covariance=told)).covariance, told)
    assert np.array_equal(watch.check(good(0.2, pose=None, covariance=2 * told)).covariance, told)
