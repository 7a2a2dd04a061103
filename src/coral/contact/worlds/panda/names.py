"""robosuite's names for the parts of its Panda, and the tool frame."""

from __future__ import annotations

import mujoco
import numpy as np

JOINTS = tuple(f"robot0_joint{index}" for index in range(1, 8))
ARM_ACTUATORS = tuple(f"robot0_torq_j{index}" for index in range(1, 8))
FINGER_JOINTS = ("gripper0_right_finger_joint1", "gripper0_right_finger_joint2")
FINGER_ACTUATORS = ("gripper0_right_gripper_finger_joint1", "gripper0_right_gripper_finger_joint2")
SITE = "gripper0_right_grip_site"
WRIST_SITE = "gripper0_right_ft_frame"
HAND_BODY = "gripper0_right_right_gripper"
FORCE_SENSOR, TORQUE_SENSOR = "gripper0_right_force_ee", "gripper0_right_torque_ee"
LEFT_BODIES = ("gripper0_right_leftfinger", "gripper0_right_finger_joint1_tip")
RIGHT_BODIES = ("gripper0_right_rightfinger", "gripper0_right_finger_joint2_tip")

# The grip site's x axis is the opening direction; for the tool it is y. Both have z out of the palm.
TOOL_IN_SITE = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])

PAD_GEOMS = tuple(f"gripper0_right_finger{side}{part}_collision" for side in (1, 2) for part in ("", "_pad"))
FLOOR = "the-floor"  # a task file cannot use this name
ROBOT_PARTS = ("hand", "left", "right", "robot")
PAD_OVERLAP_M = 0.001  # the pads' faces meet before the finger joints read zero


def part_of(model: mujoco.MjModel, geom: int) -> str:
    """Return a geom's name for the judge: "left", "right", "hand", "robot", an object or a fixture."""
    name: str = model.geom(geom).name
    if int(model.geom_bodyid[geom]) == 0:
        return "floor" if name == FLOOR else name
    body: str = model.body(int(model.geom_bodyid[geom])).name
    if body in LEFT_BODIES:
        return "left"
    if body in RIGHT_BODIES:
        return "right"
    if body == HAND_BODY:
        return "hand"
    return "robot" if body.startswith(("robot0_", "fixed_mount0_")) else body
