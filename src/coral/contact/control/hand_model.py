"""A floating two-finger hand with the Panda's geometry, driven by a Cartesian impedance.

The impedance is six actuators between the tool and a mocap body, the target: force = -K e - D v with the exact pose
error, so nothing is singular below half a turn. The tool frame: z out of the palm, y along the opening.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from coral.config import Positive
from coral.contact.scene.mujoco_scene import FINGER_FRICTION, FINGER_PRIORITY, ROLLING, TORSION

MAX_OPENING_M = 0.08
SQUEEZE_M = -0.04
"""Smallest commanded opening: below zero, so that thin objects are held with the fingers' full force."""
FINGER_KG = 0.05
FLANGE_TO_TOOL_M = 0.1034
PALM_HALF_M, PALM_UP_M = (0.0315, 0.102, 0.033), -0.0704
"""Half of the palm's extents along the tool's axes, and its middle along the tool's z axis."""
FINGER_HALF_M, FINGER_UP_M = (0.010, 0.006, 0.026), -0.018
"""The same of a finger."""
FINGER_OUT_M = 0.006
"""Distance of a finger's middle from its pad, along the tool's y axis."""


@dataclass(frozen=True, kw_only=True)
class HandCfg:
    """The hand's apparent dynamics."""

    mass_kg: Positive = 4.5
    """Apparent mass at the tool, as of a Panda at mid reach (measured 3.4 to 6.1)."""
    inertia_kg_m2: Positive = 0.1
    """Apparent rotational inertia (measured 0.08 to 0.38)."""
    stiffness_n_m: Positive = 600.0
    """Default translational stiffness."""
    lever_m2: Positive = 0.05
    """Rotational stiffness in N m/rad for each N/m of translational stiffness."""
    damping_ratio: Positive = 1.0
    """Damping ratio; 1 is critical."""
    axis_force_limit_n: Positive = 60.0
    axis_torque_limit_n_m: Positive = 10.0
    """Bounds of the impedance along each axis; `reactive.force_limit_n` bounds the total pull."""
    finger_stiffness_n_m: Positive = 1000.0
    finger_force_n: Positive = 20.0
    """Force of each finger (the Panda's gripper holds with about 20 N)."""


def add_hand(spec: mujoco.MjSpec, cfg: HandCfg, condim: int = 4) -> None:
    """Add bodies "hand", "left", "right" (fingers), the site "tool", the mocap body "target" and eight actuators."""
    target = spec.worldbody.add_body(name="target", mocap=True)
    target.add_site(name="target", size=[0.005, 0.005, 0.005], group=5)
    hand = spec.worldbody.add_body(name="hand", gravcomp=1)
    for axis, name in enumerate("xyz"):
        hand.add_joint(name=f"hand_{name}", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=np.eye(3)[axis])
    hand.add_joint(name="hand_turn", type=mujoco.mjtJoint.mjJNT_BALL)
    hand.mass = cfg.mass_kg - 2 * FINGER_KG
    hand.inertia = [cfg.inertia_kg_m2] * 3
    hand.ipos = [0, 0, 0]  # at the tool, as for an operational-space impedance
    hand.explicitinertial = True
    hand.add_site(name="tool", size=[0.005, 0.005, 0.005], group=5)
    rubber = {"priority": FINGER_PRIORITY, "friction": [FINGER_FRICTION, TORSION, ROLLING], "condim": condim}
    hull = {"priority": FINGER_PRIORITY, "friction": [0.5, TORSION, ROLLING], "condim": 3, "mass": 0}
    box, capsule = mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_CAPSULE
    hand.add_geom(name="palm", type=box, size=PALM_HALF_M, pos=[0, 0, PALM_UP_M], rgba=[0.9, 0.9, 0.92, 1], **hull)
    grey = [0.85, 0.85, 0.88, 1]
    hand.add_geom(name="wrist", type=capsule, size=[0.05, 0.05, 0], pos=[0, 0, -0.2], rgba=grey, **hull)
    for name, side in (("left", 1.0), ("right", -1.0)):
        finger = hand.add_body(name=name, gravcomp=1)
        finger.add_joint(
            name=f"{name}_slide",
            type=mujoco.mjtJoint.mjJNT_SLIDE,
            axis=[0, side, 0],
            range=[0, MAX_OPENING_M / 2],
            limited=True,
            damping=15,
        )
        finger.add_geom(
            name=f"{name}_finger",
            type=box,
            size=FINGER_HALF_M,
            pos=[0, side * FINGER_OUT_M, FINGER_UP_M],
            mass=FINGER_KG,
            rgba=[0.25, 0.27, 0.3, 1],
            **rubber,
        )
        spring = spec.add_actuator(name=name, trntype=mujoco.mjtTrn.mjTRN_JOINT, target=f"{name}_slide")
        spring.gainprm[0] = cfg.finger_stiffness_n_m
        spring.biastype = mujoco.mjtBias.mjBIAS_AFFINE
        spring.biasprm[1] = -cfg.finger_stiffness_n_m
        spring.forcerange = [-cfg.finger_force_n, cfg.finger_force_n]
        spring.forcelimited = True
    for axis in range(6):
        pull = spec.add_actuator(
            name=f"pull_{axis}", trntype=mujoco.mjtTrn.mjTRN_SITE, target="tool", refsite="target", gear=np.eye(6)[axis]
        )
        pull.biastype = mujoco.mjtBias.mjBIAS_AFFINE
        limit = cfg.axis_force_limit_n if axis < 3 else cfg.axis_torque_limit_n_m
        pull.forcerange, pull.forcelimited = [-limit, limit], True
    for body in ("left", "right"):
        spec.add_exclude(bodyname1="hand", bodyname2=body)
    spec.add_exclude(bodyname1="left", bodyname2="right")


def set_stiffness(model: mujoco.MjModel, cfg: HandCfg, stiffness_n_m: float) -> None:
    """Set the stiffness of the impedance, critically damped for the hand's apparent inertia."""
    for axis in range(6):
        pull = model.actuator(f"pull_{axis}").id
        gain = stiffness_n_m if axis < 3 else stiffness_n_m * cfg.lever_m2
        inertia = cfg.mass_kg if axis < 3 else cfg.inertia_kg_m2
        model.actuator_gainprm[pull, 0] = gain
        model.actuator_biasprm[pull, 1] = -gain
        model.actuator_biasprm[pull, 2] = -2 * cfg.damping_ratio * np.sqrt(gain * inertia)
