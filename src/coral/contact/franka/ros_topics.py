"""Topics and services of an arm over ROS 2, in its namespace: those of franka_ros2, or others by parameters."""

from __future__ import annotations

from coral.ros.ros_node import RosNode

STATE = "franka_robot_state_broadcaster"
ROWS = {
    "joint_states": (f"{STATE}/measured_joint_states", "sensor_msgs/JointState", "Read: seven joints, with speeds."),
    "current_pose": (f"{STATE}/current_pose", "geometry_msgs/PoseStamped", "Read: the tool in the arm's base frame."),
    "wrench": (
        f"{STATE}/external_wrench_in_base_frame",
        "geometry_msgs/WrenchStamped",
        "Read: of the surroundings on the hand.",
    ),
    "gripper_joint_states": ("franka_gripper/joint_states", "sensor_msgs/JointState", "Read: both fingers, in metres."),
    "poses.NAME": ("objects/NAME", "geometry_msgs/PoseStamped", "Read, in the frame `world`, `*link0` or `*tcp`."),
    "detections": ("", "vision_msgs/Detection3DArray", "Read if its topic is given: objects by class or id."),
    "equilibrium_pose": (
        "cartesian_impedance_controller/equilibrium_pose",
        "geometry_msgs/PoseStamped",
        "200 Hz: where the controller pulls the tool, base frame.",
    ),
    "gripper_opening": ("franka_gripper/opening", "std_msgs/Float64", "200 Hz: distance between the finger pads, m."),
    "stop": ("stop", "std_srvs/Trigger", "Called at a stop, if it exists."),
    "-": ("coral/stop", "std_srvs/Trigger", "A service that stops the arm."),
}
"""By ROS parameter: the name that holds without it, the type, and what it is."""
TOPICS = {
    name or f"({parameter})": (kind, what if parameter == "-" else f"{what} Parameter `{parameter}`.")
    for parameter, (name, kind, what) in ROWS.items()
}
"""Type of each topic, and what is on it."""


def topic(ros: RosNode, parameter: str, name: str = "") -> str:
    """Return the name that a parameter gives, or else the usual one; `name` is that of an object."""
    usual = ROWS[parameter][0].replace("NAME", name.replace("-", "_"))
    return ros.parameter(parameter.replace("NAME", name), usual)
