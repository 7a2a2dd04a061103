"""A robot under ROS 2 in a process of its own: franky-sim's arm and a Cartesian impedance controller behind topics.

Its topics are those of franka_ros2 and of a tracker. Nothing of the truth is on them.

Usage: python arm_node.py ADDRESS NAMESPACE; it prints the UDP port at which it takes the tracker's datagrams.
"""

import argparse
import os
import socket
import sys

import numpy as np
import rclpy
from geometry_msgs.msg import PoseStamped, WrenchStamped
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from std_srvs.srv import Trigger

from coral.contact.franka.arm import ArmError
from coral.contact.franka.double import cfg_for_double
from coral.contact.franka.franky_arm import FrankyArm
from coral.contact.franka.object_poses import LARGEST, parse_poses
from coral.contact.scene.observation import HandTarget
from coral.contact.worlds.franka_cfg import FrankaCfg

STIFFNESS_N_M = 600.0
PERIOD_S = 0.005
STATE = "franka_robot_state_broadcaster"


class ArmNode:
    """Publishes the simulated arm's state and follows the equilibrium pose; without a new one it holds the last."""

    def __init__(self, node, arm):
        self.node, self.arm, self.now = node, arm, None
        self.stopped = self.covered = False
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setblocking(False)
        self.socket.bind(("127.0.0.1", 0))
        publisher = node.create_publisher
        self.joints = publisher(JointState, f"{STATE}/measured_joint_states", qos_profile_sensor_data)
        self.pose = publisher(PoseStamped, f"{STATE}/current_pose", qos_profile_sensor_data)
        self.wrench = publisher(WrenchStamped, f"{STATE}/external_wrench_in_base_frame", qos_profile_sensor_data)
        self.gripper = publisher(JointState, "franka_gripper/joint_states", qos_profile_sensor_data)
        self.objects = {}
        node.create_subscription(PoseStamped, "cartesian_impedance_controller/equilibrium_pose", self.follow, 1)
        node.create_subscription(Float64, "franka_gripper/opening", self.open_to, 1)
        for name in ("stop", "cover"):
            node.create_service(Trigger, name, getattr(self, f"on_{name}"))
        node.create_timer(PERIOD_S, self.tick)

    def tick(self):
        self.now = now = self.arm.read()
        joints = JointState(position=now.joints.tolist(), velocity=now.joint_speeds.tolist())
        joints.name = [f"fr3_joint{k}" for k in range(1, 8)]
        pose = posed(now.position, now.quaternion)
        wrench = WrenchStamped()
        for part, values in ((wrench.wrench.force, now.wrench[:3]), (wrench.wrench.torque, now.wrench[3:])):
            part.x, part.y, part.z = map(float, values)
        fingers = JointState(name=["fr3_finger_joint1", "fr3_finger_joint2"], position=[now.opening_m / 2] * 2)
        for message, publisher in (
            (joints, self.joints),
            (pose, self.pose),
            (wrench, self.wrench),
            (fingers, self.gripper),
        ):
            message.header.frame_id, message.header.stamp = "fr3_link0", self.stamp()
            publisher.publish(message)
        self.pass_poses_on()

    def stamp(self):
        """The arm's clock."""
        return rclpy.time.Time(nanoseconds=int(1e9 * (1.0 + self.now.time_s))).to_msg()

    def pass_poses_on(self):
        while True:
            try:
                found = parse_poses(self.socket.recv(LARGEST))
            except BlockingIOError:
                return
            for name, (body, _) in {} if self.covered else found.items():
                if name not in self.objects:
                    topic = f"objects/{name.replace('-', '_')}"
                    self.objects[name] = self.node.create_publisher(PoseStamped, topic, qos_profile_sensor_data)
                message = posed(body.position, body.quaternion)
                message.header.frame_id, message.header.stamp = "world", self.stamp()
                self.objects[name].publish(message)

    def follow(self, message):
        if self.stopped:
            return
        at, q = message.pose.position, message.pose.orientation
        target = HandTarget(np.array([at.x, at.y, at.z]), np.array([q.w, q.x, q.y, q.z]), 0.08, STIFFNESS_N_M)
        try:
            self.arm.follow(target)
        except ArmError as error:
            self.stopped = True
            print(f"the simulated arm refused: {error}", file=sys.stderr)

    def open_to(self, message):
        try:
            self.arm.open_to(message.data)
        except ArmError as error:
            print(f"the simulated gripper refused: {error}", file=sys.stderr)

    def on_stop(self, request, response):
        self.stopped = True
        self.arm.stop()
        return done(response)

    def on_cover(self, request, response):
        """Cover the tracker."""
        self.covered = True
        return done(response)


def posed(position, quaternion):
    message = PoseStamped()
    at, q = message.pose.position, message.pose.orientation
    at.x, at.y, at.z = map(float, position)
    q.w, q.x, q.y, q.z = map(float, quaternion)
    return message


def done(response):
    response.success = True
    return response


def main():
    flags = argparse.ArgumentParser()
    flags.add_argument("address")
    flags.add_argument("namespace")
    told = flags.parse_args()
    arm = FrankyArm(told.address, cfg_for_double(FrankaCfg()))
    # The driver has given this thread a priority above all others, which the node's threads would inherit.
    os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    rclpy.init()
    robot = ArmNode(rclpy.create_node("arm", namespace=told.namespace), arm)
    print(robot.socket.getsockname()[1], flush=True)
    rclpy.spin(robot.node)


if __name__ == "__main__":
    main()
