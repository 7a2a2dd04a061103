"""A vehicle that speaks ROS 2: odometry in, velocities out.

Topics, relative to the node's namespace; parameters of the same names in a ROS parameter file rename them:

    odom       nav_msgs/Odometry: x east, y north, z up, z = 0 at the surface; twist in the body's frame (REP-103)
    battery    sensor_msgs/BatteryState, if there is one
    cmd_vel    geometry_msgs/Twist, at 10 Hz: forward (m/s), up (m/s, to hold the depth), yaw rate (rad/s)
    arm        std_srvs/SetBool, if there is one

The vehicle must stop by itself when `cmd_vel` falls silent: there is no other failsafe here.
"""

from __future__ import annotations

import math
import threading
import time
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from coral.reef.recordings.frame_tree import frame_name, points_down
from coral.reef.recordings.transforms import euler_of, rotation_of
from coral.reef.sea.link import LinkRefused, VehicleReport
from coral.reef.world.geometry import Pose
from coral.ros.ros_node import OtherClockError, RosNode, ros_type

PERIOD_S = 0.1
SILENT_S = 0.5
"""Without a set-point of the program for this long, the vehicle is told to stand still."""
DEPTH_GAIN, CLIMB_M_S = 0.5, 0.2
"""Vertical speed per metre of depth error (1/s), and its limit; also the speed of an ascent."""
ANSWER_S = 5.0
"""Longest wait for the service that arms."""
Mode = Literal["idle", "driven", "hold", "surface"]
PLANAR = (0, 1, 5)
"""Rows of x, y and yaw in a covariance of six."""


class RosLink:
    """Reads a vehicle's odometry and sends it velocities, on the node's thread. Safe to use from any thread.

    `place` is the vehicle's namespace, or a file of ROS parameters.

    Raises:
        InputError: There is no ROS 2.
    """

    def __init__(self, place: str = "", node: RosNode | None = None) -> None:
        self.ros = ros = node or RosNode("coral_vehicle", place, "--vehicle")
        self._lock = threading.Lock()
        self._seen = VehicleReport()
        self._arrived_s = self._commanded_s = -math.inf
        self._fault = ""
        self.odom_frame = ""
        """Frame of the odometry; "" until one is heard."""
        self._mode: Mode = "idle"
        self._command = (0.0, 0.0, 0.0)
        self._twist = ros_type("geometry_msgs.msg.Twist")
        self._odom, self._cmd_vel = ros.parameter("odom", "odom"), ros.parameter("cmd_vel", "cmd_vel")
        create = ros.node.create_subscription
        create(ros_type("nav_msgs.msg.Odometry"), self._odom, self._hear, ros.qos("sensor"))
        battery = ros.parameter("battery", "battery")
        create(ros_type("sensor_msgs.msg.BatteryState"), battery, self._hear_battery, ros.qos("sensor"))
        self._publisher = ros.node.create_publisher(self._twist, self._cmd_vel, 1)
        self._set_bool = ros_type("std_srvs.srv.SetBool")
        self._arm = ros.node.create_client(self._set_bool, ros.parameter("arm", "arm"))
        ros.node.create_timer(PERIOD_S, self._keep)

    def report(self) -> VehicleReport:
        """Return the latest state."""
        with self._lock:
            seen, fault, mode = self._seen, self._fault, self._mode
            age_s = time.monotonic() - self._arrived_s
        others = self._others()
        return replace(
            seen,
            has_position=seen.pose is not None and not fault,
            mode=mode,
            armed=mode != "idle",
            autopilot=f"ROS 2 odometry on {self._odom}",
            identity_faults=tuple(each for each in (fault, *self._strangers(), others) if each),
            heartbeat_age_s=age_s if math.isfinite(age_s) else math.inf,
            manual_override=bool(others) and mode == "driven",
        )

    def command(self, forward_m_s: float, yaw_rate_rad_s: float, depth_m: float) -> None:
        """Send one set-point, while the vehicle is armed; numbers that are not finite stop it."""
        command = (forward_m_s, yaw_rate_rad_s, depth_m)
        with self._lock:
            if self._mode != "driven":
                return
            self._command = command if all(map(math.isfinite, command)) else (0.0, 0.0, self._command[2])
            self._commanded_s = time.monotonic()
        self._send(*self._command)

    def arm(self) -> None:
        """Take control, by the vehicle's service where it has one.

        Raises:
            LinkRefused: Nobody listens, somebody else commands, or the service said no.
        """
        if not self.ros.node.count_subscribers(self._cmd_vel):
            raise LinkRefused(f"nobody listens to {self._cmd_vel}")
        if others := self._others():
            raise LinkRefused(others)
        self._ask_to_arm(armed=True)
        self._enter("driven")

    def disarm(self) -> None:
        """Stop, and send nothing more."""
        self._send(0.0, 0.0, math.nan)
        self._enter("idle")
        self._ask_to_arm(armed=False)

    def hold(self) -> None:
        """Stand still, at this depth."""
        self._enter("hold")

    def surface(self) -> None:
        """Come up."""
        self._enter("surface")

    def close(self) -> None:
        """Stop the vehicle and end the node."""
        if self._mode != "idle":
            self._send(0.0, 0.0, math.nan)
        self.ros.close()

    def _enter(self, mode: Mode) -> None:
        with self._lock:
            depth_m = self._seen.depth_m
            self._mode, self._command = mode, (0.0, 0.0, math.nan if depth_m is None else depth_m)
            self._commanded_s = time.monotonic()

    def _keep(self) -> None:
        """Keep sending if nobody else does: a hold, an ascent, and a stop when the program falls silent."""
        with self._lock:
            mode, command = self._mode, self._command
            silent = time.monotonic() - self._commanded_s > SILENT_S
        if mode == "surface":
            self._send(0.0, 0.0, -math.inf)
        elif mode == "hold" or (mode == "driven" and silent):
            self._send(0.0, 0.0, command[2])

    def _send(self, forward_m_s: float, yaw_rate_rad_s: float, depth_m: float) -> None:
        message, depth = self._twist(), self._seen.depth_m
        message.linear.x, message.angular.z = float(forward_m_s), float(yaw_rate_rad_s)
        if depth is not None and not math.isnan(depth_m):
            message.linear.z = max(-CLIMB_M_S, min(CLIMB_M_S, DEPTH_GAIN * (depth - depth_m)))
        self._publisher.publish(message)

    def _hear(self, message: Any) -> None:
        fault, found, velocity = frame_fault(message), pose_of(message), velocity_of(message)
        self.odom_frame = frame_name(str(message.header.frame_id))
        try:
            stamp_s = self.ros.monotonic(message.header.stamp)
        except OtherClockError as error:
            fault = fault or f"{self._odom}: {error}"
        with self._lock:
            self._arrived_s, self._fault = time.monotonic(), fault
            if fault or found is None or velocity is None or stamp_s <= self._seen.pose_stamp_s:
                return
            pose, z, roll, pitch = found
            self._seen = replace(
                self._seen,
                pose=pose,
                pose_stamp_s=stamp_s,
                covariance=covariance_of(message),
                roll_rad=roll,
                pitch_rad=pitch,
                yaw_rad=pose.theta,
                attitude_stamp_s=stamp_s,
                depth_m=-z,
                depth_stamp_s=stamp_s,
                velocity=velocity,
                velocity_stamp_s=stamp_s,
            )

    def _hear_battery(self, message: Any) -> None:
        volts, share = float(message.voltage), float(message.percentage)
        with self._lock:
            self._seen = replace(
                self._seen,
                battery_v=volts if math.isfinite(volts) and volts > 0.0 else None,
                battery_fraction=share if 0.0 <= share <= 1.0 else None,
            )

    def _strangers(self) -> list[str]:
        """Return why it is not certain whose odometry this is."""
        count = self.ros.node.count_publishers(self._odom)
        return [f"{count} nodes publish {self._odom}"] if count > 1 else []

    def _others(self) -> str:
        """Return who else commands the vehicle, or ""."""
        count = self.ros.node.count_publishers(self._cmd_vel) - 1
        return f"{count} other node{'s' * (count > 1)} may publish {self._cmd_vel}" if count > 0 else ""

    def _ask_to_arm(self, *, armed: bool) -> None:
        if not self._arm.service_is_ready():
            return
        answer = self._arm.call_async(self._set_bool.Request(data=armed))
        done = threading.Event()
        answer.add_done_callback(lambda _: done.set())
        if not done.wait(ANSWER_S):
            raise LinkRefused(f"{self._arm.srv_name} does not answer")
        result = answer.result()
        if not result.success:
            raise LinkRefused(f"{self._arm.srv_name}: {result.message or 'no'}")


def frame_fault(message: Any) -> str:
    """Return why an odometry's frames are not east-north-up and forward-left-up, or ""."""
    for frame in (str(message.header.frame_id), str(message.child_frame_id)):
        if points_down(frame):
            return f"odometry in {frame!r}: x east, y north, z up is needed (REP-103)"
    return ""


def pose_of(message: Any) -> tuple[Pose, float, float, float] | None:
    """Return the planar pose, z (m, up), roll and pitch (rad) of an odometry; None if it has no finite ones."""
    at, q = message.pose.pose.position, message.pose.pose.orientation
    values = (at.x, at.y, at.z, q.x, q.y, q.z, q.w)
    length = math.sqrt(q.x**2 + q.y**2 + q.z**2 + q.w**2)
    if not all(map(math.isfinite, values)) or not 0.9 < length < 1.1:
        return None
    roll, pitch, yaw = euler_of(rotation_of((q.x, q.y, q.z, q.w)))
    return Pose(at.x, at.y, yaw), at.z, roll, pitch


def velocity_of(message: Any) -> tuple[float, float, float] | None:
    """Return m/s forward, m/s to the left and rad/s to the left; None if they are not finite."""
    linear, angular = message.twist.twist.linear, message.twist.twist.angular
    found = (float(linear.x), float(linear.y), float(angular.z))
    return found if all(map(math.isfinite, found)) else None


def covariance_of(message: Any) -> NDArray[np.float64] | None:
    """Return the covariance of x, y (m) and yaw (rad); None if it is unknown: all zero, or -1. Shape=(3, 3)."""
    full = np.asarray(message.pose.covariance, float).reshape(6, 6)
    planar = full[np.ix_(PLANAR, PLANAR)]
    told = bool(np.isfinite(planar).all() and planar[0, 0] > 0.0 and planar[1, 1] > 0.0)
    return planar if told else None
