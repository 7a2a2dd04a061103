"""An arm behind Franka Robotics' control interface, through the package franky-control."""

from __future__ import annotations

import contextlib
import threading
from dataclasses import dataclass
from typing import Any

import numpy as np

from coral.contact.control.hand_model import HandCfg
from coral.contact.scene.geometry import quaternion_of
from coral.contact.scene.observation import Array, HandTarget
from coral.contact.worlds.franka_cfg import FrankaCfg
from coral.errors import InputError, RunError, first_line, install_extra

MISSING = f"{install_extra('franka')}, for the package franky-control"
STOP_RAMP_S = 0.02
"""Time in which the torques of the impedance give way to pure damping."""
STOP_DAMPING = np.array([60.0, 60.0, 60.0, 60.0, 15.0, 15.0, 10.0])
"""Damping of each joint during a stop, N m s/rad."""
GRIPPER_S = 0.02
"""Pause between two readings of the gripper."""
OPENING_STEP_M = 0.004
"""Smallest change of the commanded opening that is worth a command: the gripper takes a few a second."""


class ArmError(RuntimeError):
    """The arm refused a command, or its link is down."""


@dataclass(frozen=True)
class ArmState:
    """What the arm measures, in its base frame."""

    time_s: float
    """The arm's own clock."""
    joints: Array
    """Shape=(7,) rad."""
    joint_speeds: Array
    """Shape=(7,) rad/s."""
    position: Array
    """Shape=(3,) m, of the tool."""
    quaternion: Array
    """Shape=(4,), of the tool."""
    twist: Array
    """Shape=(6,) velocity of the tool (m/s) and angular velocity (rad/s)."""
    wrench: Array
    """Shape=(6,) force (N) and torque (N m) of the surroundings on the hand, as the arm estimates them: with bias and
    noise."""
    opening_m: float
    """Distance between the finger pads."""
    fault: str = ""
    """Why the arm does not obey (a reflex, the user's stop button); "" while it does."""


def franky() -> Any:
    """Import the package.

    Raises:
        InputError: It is not installed.
    """
    try:
        import franky as package
    except ImportError as error:
        raise InputError("--world", "", f"franka ({error})", MISSING) from None
    return package


class FrankyArm:
    """Drives a Panda or FR3 by Cartesian impedance. No method waits for the end of a motion.

    Raises:
        InputError: The package is missing, or nothing answers at the address.
        RunError: The arm speaks another version of the protocol, or has no gripper.
    """

    def __init__(self, address: str, cfg: FrankaCfg) -> None:
        self._franky = package = franky()
        self._cfg = cfg
        kernel = package.RealtimeConfig.Enforce if cfg.realtime_kernel else package.RealtimeConfig.Ignore
        try:
            self._robot = package.Robot(address, relative_dynamics_factor=cfg.start_speed, realtime_config=kernel)
            self._gripper = package.Gripper(address)
        except package.NetworkException as error:
            expected = "the address of an arm with its FCI active"
            raise InputError("--robot", "", f"{address} ({first_line(error)})", expected) from None
        except Exception as error:
            raise RunError(f"the arm at {address} cannot be used: {first_line(error)}") from None
        self._tracker: Any = None
        self._stiffness = 0.0
        self._going = False
        self._grip: Any = None
        self._grip_goal: float | None = None
        self._opening, self._closed = float(self._gripper.width), threading.Event()
        threading.Thread(target=self._watch_gripper, name="franka-gripper", daemon=True).start()

    def read(self) -> ArmState:
        """Return the newest state.

        Raises:
            ArmError: There is none.
        """
        try:
            state = self._robot.state
        except Exception as error:
            raise ArmError(first_line(error)) from None
        pose = np.asarray(state.O_T_EE.matrix)
        return ArmState(
            float(state.time.to_sec()),
            np.asarray(state.q, float),
            np.asarray(state.dq, float),
            pose[:3, 3].copy(),
            quaternion_of(pose[:3, :3]),
            self._twist(state),
            np.asarray(state.O_F_ext_hat_K, float),
            self._opening,
            self._fault(state),
        )

    def go_to(self, joints: Array) -> None:
        """Begin a slow motion to a posture, Shape=(7,) rad."""
        with self._translating():
            self._robot.recover_from_errors()
            self._robot.move(self._franky.JointMotion(list(joints)), asynchronous=True)
        self._going = True

    def arrived(self) -> bool:
        """Return whether the motion of `go_to` has ended.

        Raises:
            ArmError: It was aborted.
        """
        with self._translating():
            if self._going and not self._robot.poll_motion():
                self._robot.join_motion()
                self._going = False
        return not self._going

    def follow(self, target: HandTarget) -> None:
        """Pull the tool towards a target in the base frame, as a spring; the first call begins the motion.

        Raises:
            ArmError: The arm does not obey.
        """
        x, w = target.position, target.quaternion
        pose = self._franky.Affine(np.asarray(x), np.array([w[1], w[2], w[3], w[0]]))
        with self._translating():
            if self._tracker is None:
                posture = self._franky.PostureTask(np.asarray(self._cfg.start_rad), self._cfg.posture_stiffness)
                self._tracker = self._franky.CartesianImpedanceTracker(
                    self._robot, gains=self._gains(target.stiffness), posture_task=posture, friction=self._friction()
                )
                self._stiffness = target.stiffness
            elif target.stiffness != self._stiffness:
                self._tracker.set_gains(gains=self._gains(target.stiffness))
                self._stiffness = target.stiffness
            if not self._robot.is_in_control:
                self._robot.poll_motion()  # raises what ended the motion
                raise ArmError("the arm's control has ended")
            self._tracker.set_target(pose)

    def open_to(self, opening_m: float) -> None:
        """Command an opening of the gripper, at every tick; closing on an object holds it with the gripper's force."""
        cfg, width = self._cfg, min(max(opening_m, 0.0), 0.08)
        if self._grip is not None and not self._grip.wait(0.0):
            return  # the gripper is busy; the stream asks again at its next tick
        goal = self._grip_goal
        if goal is not None and abs(width - goal) < OPENING_STEP_M and not (width == 0.0 < goal):
            return
        with self._translating():
            if goal is not None and width < goal:
                self._grip = self._gripper.grasp_async(
                    width, cfg.grip_speed_m_s, cfg.grip_force_n, epsilon_inner=0.08, epsilon_outer=0.08
                )
            else:
                self._grip = self._gripper.move_async(width, cfg.grip_speed_m_s)
        self._grip_goal = width

    def stop(self) -> None:
        """Stop all motion of the arm; the gripper keeps its hold. Never raises."""
        with contextlib.suppress(Exception):
            if self._tracker is not None and self._robot.is_in_control:
                motion = self._franky.TorqueStopMotion(damping=STOP_DAMPING, ramp_duration=STOP_RAMP_S)
                self._robot.move(motion, asynchronous=True)
            else:
                self._robot.stop()

    def close(self) -> None:
        """Release the connection. Never raises."""
        self._closed.set()
        with contextlib.suppress(Exception):
            self._robot.join_motion(1.0)

    def _gains(self, stiffness: float) -> Any:
        hand = HandCfg()  # damped critically for the default hand's inertia
        gain = np.array([stiffness] * 3 + [stiffness * hand.lever_m2] * 3)
        inertia = np.array([hand.mass_kg] * 3 + [hand.inertia_kg_m2] * 3)
        return self._franky.CartesianImpedanceGains.diagonal(gain, 2.0 * np.sqrt(gain * inertia))

    def _friction(self) -> Any:
        friction = list(self._cfg.joint_friction_n_m)
        return self._franky.FrictionCompensationParams(
            coulomb=friction, max_torque=friction, velocity_epsilon=self._cfg.friction_speed_rad_s
        )

    def _twist(self, state: Any) -> Array:
        jacobian = np.asarray(self._robot.model.zero_jacobian(self._franky.Frame.EndEffector, state))
        return np.asarray(jacobian @ np.asarray(state.dq, float))

    def _watch_gripper(self) -> None:
        """Read the opening again and again, beside the stream: reading it waits for the gripper's next message."""
        while not self._closed.wait(GRIPPER_S):
            with contextlib.suppress(Exception):
                self._opening = float(self._gripper.width)

    def _fault(self, state: Any) -> str:
        mode = self._franky.RobotMode
        if state.robot_mode in (mode.Reflex, mode.UserStopped, mode.Guiding):
            return f"the arm is in the mode {state.robot_mode.name}"
        return ""

    @contextlib.contextmanager
    def _translating(self) -> Any:
        try:
            yield
        except ArmError:
            raise
        except Exception as error:
            raise ArmError(first_line(error)) from None
