"""Calls of franky-control, against a stand-in for the package: what is sent, and how its errors come back."""

import dataclasses
import threading
from types import SimpleNamespace

import numpy as np
import pytest
from arms import DOWN, START, TOOL

from coral.contact.franka import franky_arm
from coral.contact.franka.franky_arm import ArmError, FrankyArm
from coral.contact.scene.observation import HandTarget
from coral.contact.worlds.franka_cfg import FrankaCfg
from coral.errors import InputError, RunError

MATRIX = np.diag([1.0, -1.0, -1.0, 1.0])
MATRIX[:3, 3] = TOOL
MODES = SimpleNamespace(Idle="Idle", Reflex=SimpleNamespace(name="Reflex"), UserStopped="u", Guiding="g")


class NetworkError(Exception):
    pass


class Robot:
    def __init__(self, address, **settings):
        if address == "10.0.0.9":
            raise NetworkError("connection refused\nand more")
        if address == "old":
            raise ValueError("server version 3")
        self.moves, self.is_in_control, self.stopped, self.moving, self.fails = [], True, False, True, False
        self.model = SimpleNamespace(zero_jacobian=lambda frame, state: np.eye(6, 7))
        self.mode = "Idle"

    @property
    def state(self):
        if self.fails:
            raise NetworkError("UDP timeout")
        time = SimpleNamespace(to_sec=lambda: 12.5)
        pose = SimpleNamespace(matrix=MATRIX)
        return SimpleNamespace(
            time=time, q=START, dq=np.arange(7) / 10, O_T_EE=pose, O_F_ext_hat_K=np.arange(6), robot_mode=self.mode
        )

    def move(self, motion, asynchronous):
        assert asynchronous  # the stream never waits
        self.moves.append(motion)

    def recover_from_errors(self):
        return True

    def poll_motion(self):
        return self.moving

    def join_motion(self, timeout=None):
        return True

    def stop(self):
        self.stopped = True


class Gripper:
    width, calls, done = 0.07, [], True

    def __init__(self, address):
        self.calls = []

    def _later(self, *call, **more):
        self.calls.append((*call, more.get("epsilon_outer")))
        return SimpleNamespace(wait=lambda seconds: self.done)

    def grasp_async(self, width, speed, force, **more):
        return self._later("grasp", width, force, **more)

    def move_async(self, width, speed):
        return self._later("move", width)


class Tracker:
    def __init__(self, robot, gains, posture_task, friction):
        self.gains, self.targets, self.friction = [gains], [], friction

    def set_gains(self, gains):
        self.gains.append(gains)

    def set_target(self, pose):
        self.targets.append(pose)


PACKAGE = SimpleNamespace(
    Robot=Robot,
    Gripper=Gripper,
    NetworkException=NetworkError,
    RealtimeConfig=SimpleNamespace(Enforce=1, Ignore=0),
    RobotMode=MODES,
    Frame=SimpleNamespace(EndEffector="ee"),
    Affine=lambda place, quaternion: (tuple(place), tuple(quaternion)),
    PostureTask=lambda target, stiffness: None,
    JointMotion=lambda joints: ("joints", tuple(joints)),
    TorqueStopMotion=lambda **values: "torque stop",
    CartesianImpedanceTracker=Tracker,
    FrictionCompensationParams=SimpleNamespace,
    CartesianImpedanceGains=SimpleNamespace(diagonal=lambda gain, damping: (gain, damping)),
)


@pytest.fixture
def arm(monkeypatch):
    monkeypatch.setattr(franky_arm, "franky", lambda: PACKAGE)
    monkeypatch.setattr(threading.Thread, "start", lambda self: None)  # the gripper is not watched
    return FrankyArm("10.0.0.1", FrankaCfg())


def test_the_state_is_read(arm):
    state = arm.read()
    assert state.time_s == 12.5
    assert state.position == pytest.approx(TOOL)
    assert abs(state.quaternion @ DOWN) == pytest.approx(1.0)
    assert state.twist == pytest.approx(np.arange(6) / 10)
    assert state.wrench == pytest.approx(np.arange(6))
    assert (state.opening_m, state.fault) == (0.07, "")


def test_a_reflex_is_a_fault_and_a_dead_link_an_error(arm):
    arm._robot.mode = MODES.Reflex
    assert arm.read().fault == "the arm is in the mode Reflex"
    arm._robot.fails = True
    with pytest.raises(ArmError, match="UDP timeout"):
        arm.read()


def test_targets_go_to_one_tracker_with_critical_damping(arm):
    arm.follow(HandTarget(TOOL, np.array([0.5, 0.1, 0.2, 0.3]), 0.08, 400.0))
    tracker = arm._tracker
    arm.follow(HandTarget(TOOL, DOWN, 0.08, 400.0))
    assert arm._tracker is tracker
    assert tracker.targets[0] == (tuple(TOOL), (0.1, 0.2, 0.3, 0.5))  # the package's quaternions end with w
    gain, damping = tracker.gains[0]
    assert gain == pytest.approx([400.0] * 3 + [20.0] * 3)
    assert damping[0] == pytest.approx(2 * np.sqrt(400.0 * 4.5))
    assert len(tracker.gains) == 1
    arm.follow(HandTarget(TOOL, DOWN, 0.08, 500.0))
    assert len(tracker.gains) == 2


def test_no_joint_gets_more_than_its_friction(arm):
    friction = (0.9, 0.9, 0.9, 0.9, 0.6, 0.35, 0.2)
    arm._cfg = dataclasses.replace(arm._cfg, joint_friction_n_m=friction)
    arm.follow(HandTarget(TOOL, DOWN, 0.08, 400.0))
    made_up = arm._tracker.friction
    assert (tuple(made_up.coulomb), tuple(made_up.max_torque)) == (friction, friction)


def test_an_arm_that_left_control_is_an_error(arm):
    arm.follow(HandTarget(TOOL, DOWN, 0.08, 400.0))
    arm._robot.is_in_control = False
    with pytest.raises(ArmError, match="control has ended"):
        arm.follow(HandTarget(TOOL, DOWN, 0.08, 400.0))


def test_the_way_to_the_start_is_awaited_without_waiting(arm):
    arm.go_to(START)
    assert arm._robot.moves == [("joints", tuple(START))]
    assert not arm.arrived()
    arm._robot.moving = False
    assert arm.arrived()


def test_closing_grasps_with_force_and_opening_moves(arm):
    for width in (0.08, 0.079, 0.05, -0.04, 0.06):
        arm.open_to(width)
    assert arm._gripper.calls == [
        ("move", 0.08, None),
        ("grasp", 0.05, 20.0, 0.08),
        ("grasp", 0.0, 20.0, 0.08),
        ("move", 0.06, None),
    ]


def test_a_busy_gripper_gets_no_second_command(arm):
    arm.open_to(0.08)
    arm._gripper.done = False
    arm.open_to(0.02)
    assert len(arm._gripper.calls) == 1


def test_a_stop_ends_the_impedance_softly_and_any_other_motion_at_once(arm):
    arm.stop()
    assert arm._robot.stopped
    arm.follow(HandTarget(TOOL, DOWN, 0.08, 400.0))
    arm.stop()
    assert arm._robot.moves == ["torque stop"]


def test_bad_addresses_are_told_in_one_line(arm):
    with pytest.raises(InputError, match=r"--robot: found 10.0.0.9 \(connection refused\), expected the address"):
        FrankyArm("10.0.0.9", FrankaCfg())
    with pytest.raises(RunError, match="the arm at old cannot be used: server version 3"):
        FrankyArm("old", FrankaCfg())


def test_a_missing_package_is_told_with_its_extra(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "franky", None)
    with pytest.raises(InputError, match=r"--world: found franka .*expected the extra franka"):
        franky_arm.franky()
