"""An arm over ROS 2: its state as franka_ros2 publishes it, and a Cartesian impedance controller's equilibrium pose."""

from __future__ import annotations

import contextlib
import re
import threading
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from coral.contact.control.hand_model import FLANGE_TO_TOOL_M, HandCfg
from coral.contact.franka.arm import ArmError, ArmState
from coral.contact.franka.arm_geometry import link_frames
from coral.contact.franka.ros_poses import FLAG, RosPoses, pose_arrays, stamp_seconds
from coral.contact.franka.ros_topics import topic
from coral.contact.scene.geometry import conjugate, from_rotvec, multiply, quaternion_of, to_rotvec
from coral.contact.scene.observation import Array, HandTarget
from coral.contact.worlds.franka_cfg import FrankaCfg
from coral.errors import InputError
from coral.ros.ros_node import RosNode, ros_type

PREFIX = "ros2:"
"""With what an address begins that is a namespace, or a file of ROS parameters."""
FLANGE_M = 0.107
"""From the last joint's frame to the flange, along its axis."""
HAND_TURN_RAD = -np.pi / 4
"""Turn of the hand about it."""
FIRST_S = 10.0
"""Longest wait for the first state."""
START_M_S, START_RAD_S = 0.1, 0.3
"""Speeds on the way to the start posture."""
AWAY_M, AWAY_RAD = 0.03, 0.15
"""A tool nearer to its start than this has arrived."""
LATE_S = 10.0
"""Time that it may take for it when the equilibrium is there already."""
WATCH_S = 0.1
"""Pause between two looks at who listens and who else commands."""
_JOINT = re.compile(r"(?:^|_)(finger_)?joint_?([1-7])$")
_PARTS = ("joint_states", "current_pose", "wrench")


@dataclass(frozen=True)
class _Way:
    """A straight way of the equilibrium pose, base frame."""

    began_s: float
    lasts_s: float
    position: Array
    quaternion: Array
    goal: Array
    turn: Array
    """Shape=(3,) rad, from the first orientation to the goal's."""


class RosArm:
    """Leads an arm by the equilibrium pose of its controller, whose stiffness stays as it is.

    A target of another stiffness is moved towards the tool so far that the controller pulls with the same force.

    The address is `ros2:` with a namespace or a file of ROS parameters; the objects' poses go to the `poses_host` and
    `poses_port` of the configuration.

    Raises:
        InputError: There is no ROS 2, no state comes, or nobody listens.
    """

    def __init__(
        self, address: str, cfg: FrankaCfg, objects: tuple[str, ...] = (), node: RosNode | None = None
    ) -> None:
        self._cfg, self._address = cfg, address
        self._ros = ros = node or RosNode("coral_arm", address.removeprefix(PREFIX), FLAG)
        self._lock = threading.Lock()
        self._parts: dict[str, Any] = {}
        self._stamps: dict[str, float] = {}
        self._epoch_s = 0.0
        self._frame = self._stop_reason = self._graph_fault = ""
        self._way: _Way | None = None
        self._pose_message, self._opening_message = (
            ros_type(name, FLAG) for name in ("geometry_msgs.msg.PoseStamped", "std_msgs.msg.Float64")
        )
        trigger = ros_type("std_srvs.srv.Trigger", FLAG)
        self._stiffness = float(ros.parameter("stiffness_n_m", "600"))
        self._turning_stiffness = float(ros.parameter("stiffness_n_m_rad", str(self._stiffness * HandCfg().lever_m2)))
        joint_state, wrench = ros_type("sensor_msgs.msg.JointState", FLAG), "geometry_msgs.msg.WrenchStamped"
        self._topics = {part: topic(ros, part) for part in (*_PARTS, "gripper_joint_states")}
        kinds = (joint_state, self._pose_message, ros_type(wrench, FLAG), joint_state)
        hears = (self._hear_joints, self._hear_pose, self._hear_wrench, self._hear_gripper)
        for where, kind, hear in zip(self._topics.values(), kinds, hears, strict=True):
            ros.node.create_subscription(kind, where, hear, ros.qos("sensor"))
        self._equilibrium = topic(ros, "equilibrium_pose")
        self._poses_out = ros.node.create_publisher(self._pose_message, self._equilibrium, 1)
        self._openings_out = ros.node.create_publisher(self._opening_message, topic(ros, "gripper_opening"), 1)
        ros.node.create_service(trigger, "coral/stop", self._answer_stop)
        self._arms_stop, self._trigger = ros.node.create_client(trigger, topic(ros, "stop")), trigger
        host = "127.0.0.1" if cfg.poses_host in ("", "0.0.0.0") else cfg.poses_host
        self._poses = RosPoses(ros, objects, np.asarray(cfg.base_m), (host, cfg.poses_port))
        ros.node.create_timer(WATCH_S, self._watch)
        self._await_state()

    def read(self) -> ArmState:
        """See `Arm.read`. Its time is the oldest stamp of joints, pose and wrench, so that none may fall silent."""
        with self._lock:
            missing = self._missing()
            if missing:
                raise ArmError(f"nothing came on {missing}")
            joints, speeds = self._parts["joint_states"]
            position, quaternion = self._parts["current_pose"]
            time_s = min(self._stamps[part] for part in _PARTS) - self._epoch_s
            wrench, opening = self._parts["wrench"], self._parts["gripper_joint_states"]
            fault = self._stop_reason or self._graph_fault
        twist = _twist(joints, speeds, position)
        return ArmState(time_s, joints, speeds, position, quaternion, twist, wrench, opening, fault)

    def go_to(self, joints: Array) -> None:
        """See `Arm.go_to`: the tool goes straight to where it is in this posture; the controller chooses the joints."""
        now = self.read()
        goal, quaternion = tool_pose(joints)
        turn = to_rotvec(multiply(quaternion, conjugate(now.quaternion)))
        way_m, turn_rad = float(np.linalg.norm(goal - now.position)), float(np.linalg.norm(turn))
        lasts_s = max(way_m / START_M_S, turn_rad / START_RAD_S, 0.1)
        self._way = _Way(now.time_s, lasts_s, now.position, now.quaternion, goal, turn)

    def arrived(self) -> bool:
        """See `Arm.arrived`. Each call leads the equilibrium on: a program that falls silent leads it no further."""
        way, now = self._way, self.read()
        if way is None:
            return True
        passed_s = now.time_s - way.began_s
        share = min(1.0, passed_s / way.lasts_s)
        place = way.position + share * (way.goal - way.position)
        left = place - now.position
        if float(np.linalg.norm(left)) * self._stiffness > 2.0 * self._cfg.limits.push_n:
            raise ArmError(f"the arm does not follow: it is {100 * np.linalg.norm(left):.0f} cm behind")
        self._publish(place, multiply(from_rotvec(share * way.turn), way.quaternion))
        turned = multiply(from_rotvec(way.turn), way.quaternion)
        angle = float(np.linalg.norm(to_rotvec(multiply(turned, conjugate(now.quaternion)))))
        if share < 1.0 or float(np.linalg.norm(left)) > AWAY_M or angle > AWAY_RAD:
            if passed_s > way.lasts_s + LATE_S:
                raise ArmError("the arm did not reach its start")
            return False
        self._way = None
        return True

    def follow(self, target: HandTarget) -> None:
        """See `Arm.follow`."""
        share = target.stiffness / self._stiffness
        turning_share = target.stiffness * HandCfg().lever_m2 / self._turning_stiffness
        with self._lock:
            (position, quaternion), fault = self._parts["current_pose"], self._stop_reason or self._graph_fault
        if fault:
            raise ArmError(fault)
        turn = turning_share * to_rotvec(multiply(target.quaternion, conjugate(quaternion)))
        self._publish(position + share * (target.position - position), multiply(from_rotvec(turn), quaternion))

    def open_to(self, opening_m: float) -> None:
        """See `Arm.open_to`."""
        self._openings_out.publish(self._opening_message(data=float(np.clip(opening_m, 0.0, 0.08))))

    def stop(self) -> None:
        """See `Arm.stop`: the arm's own service where there is one, and an equilibrium where the tool is."""
        with contextlib.suppress(Exception):
            if self._arms_stop.service_is_ready():
                self._arms_stop.call_async(self._trigger.Request())
            self._publish(*self._parts["current_pose"])

    def close(self) -> None:
        """See `Arm.close`."""
        with contextlib.suppress(Exception):
            self._ros.close()
            self._poses.close()

    def _publish(self, position: Array, quaternion: Array) -> None:
        message = self._pose_message()
        message.header.stamp, message.header.frame_id = self._ros.stamp(), self._frame
        at, q = message.pose.position, message.pose.orientation
        at.x, at.y, at.z = map(float, position)
        q.w, q.x, q.y, q.z = map(float, quaternion)
        self._poses_out.publish(message)

    def _await_state(self) -> None:
        end = time.monotonic() + FIRST_S
        while wrong := self._missing() or self._who_listens():
            if time.monotonic() > end:
                self.close()
                found = f"{self._address} (nothing on {wrong})" if self._missing() else f"{self._address} ({wrong})"
                raise InputError(FLAG, "", found, "an arm with its state and controller on these topics")
            time.sleep(0.01)
        self._epoch_s = min(self._stamps[part] for part in _PARTS)

    def _missing(self) -> str:
        return ", ".join(where for part, where in self._topics.items() if part not in self._parts)

    def _who_listens(self) -> str:
        if not self._ros.node.count_subscribers(self._equilibrium):
            return f"nobody listens to {self._equilibrium}"
        others = self._ros.node.count_publishers(self._equilibrium) - 1
        return f"{others} other node{'s' * (others > 1)} may publish {self._equilibrium}" if others > 0 else ""

    def _watch(self) -> None:
        self._graph_fault = self._who_listens()

    def _answer_stop(self, request: Any, response: Any) -> Any:
        self._stop_reason = "stopped by the service coral/stop"
        response.success, response.message = True, "the arm is being stopped"
        return response

    def _keep(self, part: str, value: Any, stamp: Any) -> None:
        stamp_s = stamp_seconds(stamp)
        if stamp_s > 0.0:  # without stamps nobody could tell whether the arm's clock stands still
            with self._lock:
                self._parts[part], self._stamps[part] = value, stamp_s

    def _hear_joints(self, message: Any) -> None:
        found = {
            int(match[2]): k for k, name in enumerate(message.name) if (match := _JOINT.search(name)) and not match[1]
        }
        if len(found) == 7 and len(message.velocity) == len(message.name):
            order = [found[k] for k in range(1, 8)]
            joints, speeds = (np.asarray(values, float)[order] for values in (message.position, message.velocity))
            self._keep("joint_states", (joints, speeds), message.header.stamp)

    def _hear_gripper(self, message: Any) -> None:
        fingers = [
            float(place)
            for name, place in zip(message.name, message.position, strict=False)
            if (match := _JOINT.search(name)) and match[1]
        ]
        if fingers:
            self._keep("gripper_joint_states", sum(fingers), message.header.stamp)

    def _hear_pose(self, message: Any) -> None:
        position, quaternion = pose_arrays(message.pose)
        length = float(np.linalg.norm(quaternion))
        if 0.9 < length < 1.1:
            self._frame = str(message.header.frame_id)
            self._keep("current_pose", (position, quaternion / length), message.header.stamp)

    def _hear_wrench(self, message: Any) -> None:
        force, torque = message.wrench.force, message.wrench.torque
        wrench = np.array([force.x, force.y, force.z, torque.x, torque.y, torque.z])
        self._keep("wrench", wrench, message.header.stamp)


def tool_pose(joints: Array) -> tuple[Array, Array]:
    """Return position (m) and quaternion of the tool in a posture, base frame."""
    last = link_frames(joints)[-1]
    axis = last[:3, 2]
    turn = from_rotvec(np.array([0.0, 0.0, HAND_TURN_RAD]))
    return last[:3, 3] + (FLANGE_M + FLANGE_TO_TOOL_M) * axis, multiply(quaternion_of(last[:3, :3]), turn)


def _twist(joints: Array, speeds: Array, tool: Array) -> Array:
    """Return the tool's velocity and angular velocity, Shape=(6,), by the geometric Jacobian."""
    frames = link_frames(joints)[1:]
    axes = frames[:, :3, 2]
    return np.concatenate([speeds @ np.cross(axes, tool - frames[:, :3, 3]), speeds @ axes])
