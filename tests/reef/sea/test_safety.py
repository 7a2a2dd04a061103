from dataclasses import replace

import pytest

from coral.reef.sea.link import VehicleReport
from coral.reef.sea.safety import SafetyCfg, SafetyMonitor
from coral.reef.sea.survey_file import SurveyArea
from coral.reef.world.geometry import Pose

AREA = SurveyArea(
    "tank",
    (20.0, 10.0),
    Pose(2.0, 5.0, 0.0),
    ((0, 0), (20, 0), (20, 10), (0, 10)),
    (("pier", ((10, 0), (12, 0), (12, 6), (10, 6))),),
)
HERE = Pose(5.0, 5.0, 0.0)
NOW = 1000.0
FINE = VehicleReport(
    pose=HERE,
    pose_stamp_s=NOW,
    has_position=True,
    attitude_stamp_s=NOW,
    depth_stamp_s=NOW,
    velocity_stamp_s=NOW,
    heartbeat_age_s=0.5,
    battery_fraction=0.8,
    battery_v=15.5,
)


def check(report, *, t=10.0, pose=HERE, now=NOW, cfg=None):
    return SafetyMonitor(cfg or SafetyCfg(), AREA, 600.0).check(now, t, report, pose)


def test_a_healthy_vehicle_within_its_limits_breaches_nothing():
    assert check(FINE) is None


@pytest.mark.parametrize(
    ("change", "cause", "action"),
    [
        ({"heartbeat_age_s": 4.0}, "link", "hold"),
        ({"pose_stamp_s": NOW - 0.8}, "pose", "hold"),
        ({"has_position": False}, "pose", "hold"),
        ({"reboots": 1}, "reboot", "hold"),
        ({"clock_jumps": 1}, "clock", "hold"),
        ({"leak": True}, "leak", "surface"),
        ({"battery_fraction": 0.2}, "battery", "return"),
        ({"tether_turns": -5.2}, "tether", "hold"),
    ],
)
def test_each_limit_has_its_action(change, cause, action):
    breach = check(replace(FINE, **change))
    assert (breach.cause, breach.action) == (cause, action)


def test_eyes_that_judge_nothing_for_a_while_may_hold():
    seen = iter([1.5, 0.0, 0.0, 0.8])
    cfg = SafetyCfg(on_unjudged="hold", unjudged_s=5.0)
    monitor = SafetyMonitor(cfg, AREA, 600.0, sees_m=lambda: next(seen))
    found = [monitor.check(NOW, t, FINE, HERE) for t in (10.0, 14.0, 16.0, 17.0)]
    assert [breach and (breach.cause, breach.action, breach.passing) for breach in found] == [
        *(None, None, ("eyes", "hold", True), None)
    ]
    assert found[2].reason == "the eyes have judged nothing for 6 s"


def test_by_default_a_survey_goes_on_whatever_the_eyes_judge():
    monitor = SafetyMonitor(SafetyCfg(), AREA, 600.0, sees_m=lambda: 0.0)
    assert monitor.check(NOW, 100.0, FINE, HERE) is None


def test_a_range_to_the_floor_that_falls_silent_may_hold():
    silent = replace(FINE, altitude_stamp_s=NOW - 0.8)
    assert check(silent) is None
    holds = SafetyCfg(on_floor_lost="hold")
    assert check(silent, cfg=holds).reason == "range to the floor lost: none for 0.8 s"
    assert check(replace(FINE, altitude_stamp_s=NOW - 0.6), cfg=holds) is None
    assert check(FINE, cfg=holds) is None  # none ever came


def test_silence_on_all_channels_is_a_lost_link():
    assert check(FINE, now=NOW + 0.6) is None
    assert check(FINE, now=NOW + 0.8).cause == "link"


def test_a_link_that_never_spoke_is_lost():
    assert check(VehicleReport(), pose=None).cause == "link"


def test_the_gravest_action_wins():
    breach = check(replace(FINE, leak=True, battery_fraction=0.1, pose_stamp_s=NOW - 5.0))
    assert breach.cause == "leak"


@pytest.mark.parametrize(("x", "y", "told"), [(11.0, 3.0, "keep-out 'pier'"), (21.0, 3.0, "outside the geofence")])
def test_fence_and_keep_out_stop_the_vehicle(x, y, told):
    breach = check(FINE, pose=Pose(x, y, 0.0))
    assert breach.cause == "fence"
    assert told in breach.reason


def test_the_way_back_is_begun_while_there_is_time_for_it():
    # 12 m at 0.3 m/s and 30 s of reserve: 70 s.
    far = Pose(14.0, 5.0, 0.0)
    assert check(FINE, t=529.0, pose=far) is None
    assert check(FINE, t=531.0, pose=far).cause == "time"


def test_the_battery_decline_limits_the_time_too():
    monitor, far = SafetyMonitor(SafetyCfg(), AREA, 6000.0), Pose(14.0, 5.0, 0.0)
    assert monitor.check(NOW, 0.0, replace(FINE, battery_fraction=0.8), far) is None
    # 0.4 in 400 s: 0.15 above the limit last 150 s more, 0.06 last 60 s.
    assert monitor.check(NOW, 400.0, replace(FINE, battery_fraction=0.4), far) is None
    assert monitor.check(NOW, 490.0, replace(FINE, battery_fraction=0.31), far).reason.startswith("60 s left by the b")


def test_an_action_can_be_switched_off():
    assert check(replace(FINE, leak=True), cfg=SafetyCfg(on_leak="none")) is None


def test_what_the_operator_accepts_is_no_breach_again():
    monitor, again = SafetyMonitor(SafetyCfg(), AREA, 600.0), replace(FINE, reboots=1)
    assert monitor.check(NOW, 10.0, again, HERE).cause == "reboot"
    monitor.accept(again)
    assert monitor.check(NOW, 10.0, again, HERE) is None


def test_a_clock_jump_holds_once_and_passes():
    monitor, jumped = SafetyMonitor(SafetyCfg(), AREA, 600.0), replace(FINE, clock_jumps=1)
    breach = monitor.check(NOW, 10.0, jumped, HERE)
    assert breach.passing
    assert monitor.check(NOW, 10.1, jumped, HERE) is None
