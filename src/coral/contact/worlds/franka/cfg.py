"""Configuration of a Franka arm."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from pydantic import Field

from coral.config import Count, NonNegative, Positive, Signed
from coral.contact.worlds.franka.limits import ArmLimitsCfg


@dataclass(frozen=True, kw_only=True)
class FrankaCfg:
    """The arm, its stream and its limits."""

    base_m: tuple[Signed, Signed, Signed] = (-0.5, 0.0, 0.0)
    """Foot of the arm (link 0) in the world frame, whose origin is on the table: as in the simulated Panda world. The
    arm's x axis is the world's."""
    start_rad: tuple[Signed, Signed, Signed, Signed, Signed, Signed, Signed] = (
        0.0,
        -0.1,
        0.0,
        -2.35,
        0.0,
        2.25,
        np.pi / 4,
    )
    """Posture in which an episode starts; that of the simulated Panda world."""
    start_speed: Annotated[float, Field(gt=0, le=0.5, allow_inf_nan=False)] = 0.1
    """Share of the arm's speed with which it goes there."""
    rate_hz: Annotated[float, Field(ge=50, le=1000, allow_inf_nan=False)] = 200.0
    """Rate of the stream: how often the state is checked and the target sent."""
    lever_m2: Positive = 0.05
    """Rotational stiffness (N m/rad) per translational stiffness (N/m), as for the planner's hand."""
    effective_mass_kg: Positive = 4.5
    effective_inertia_kg_m2: Positive = 0.1
    """Apparent inertia of the hand, for which the impedance is critically damped, as for the planner's hand."""
    posture_stiffness: NonNegative = 10.0
    """Stiffness towards the start posture in the nullspace, N m/rad."""
    joint_friction_n_m: tuple[
        NonNegative, NonNegative, NonNegative, NonNegative, NonNegative, NonNegative, NonNegative
    ] = (0.0,) * 7
    """Dry friction of each joint that the impedance makes up for while the joint moves; more than there is shakes."""
    friction_speed_rad_s: Positive = 0.02
    """Speed of a joint at which three quarters of its friction are made up for."""
    grip_force_n: Positive = 20.0
    """Force of the fingers."""
    grip_speed_m_s: Positive = 0.05
    """Speed of the fingers."""
    realtime_kernel: bool = False
    """Whether to refuse an operating system without a realtime kernel. Franka Robotics requires one for real arms."""
    wrench_filter_s: NonNegative = 0.01
    """Time constant of the filter on the measured wrench."""
    bias_readings: Count = 100
    """Readings averaged for the wrench's bias, in the start posture."""
    poses_host: str = "127.0.0.1"
    poses_port: Annotated[int, Field(ge=0, le=65_535)] = 5577
    """Interface and UDP port for the objects' poses."""
    poses_timeout_s: Positive = 0.25
    """The poses are lost if one of them is older than this: seven pictures of a camera with 30 Hz."""
    link_timeout_s: Positive = 0.03
    """The link is lost if the arm's clock stands still for so long."""
    watchdog_s: Positive = 0.3
    """The stream stops the arm if the program shows no sign of life for so long. Planning and thinking are no
    silence: meanwhile the arm holds its last target."""
    limits: ArmLimitsCfg = field(default_factory=ArmLimitsCfg)
    """Limits of the arm."""
