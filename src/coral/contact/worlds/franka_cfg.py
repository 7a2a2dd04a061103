"""Configuration of a Franka arm."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from pydantic import Field

from coral.config import Count, NonNegative, Positive, Signed


@dataclass(frozen=True, kw_only=True)
class ArmLimitsCfg:
    """Limits of the arm. A state beyond one of them stops it."""

    joint_margin_rad: NonNegative = 0.05
    """Distance that each joint keeps from its end."""
    joint_speed_share: Positive = 0.8
    """Share of the joints' own speed limits."""
    tool_speed_m_s: Positive = 0.8
    """Speed of the tool. The planner's targets move with 0.5 m/s at most."""
    workspace_low_m: tuple[Signed, Signed, Signed] = (-0.3, -0.4, 0.004)
    workspace_high_m: tuple[Signed, Signed, Signed] = (0.35, 0.4, 0.5)
    """Corners of the tool's box, world frame; targets are clipped to it. The pads reach 8 mm below the tool, and the
    lower side is far enough above the table that they touch it gently at worst."""
    workspace_margin_m: NonNegative = 0.03
    """A tool farther than this outside of the box stops the arm."""
    self_distance_m: NonNegative = 0.01
    """Smallest distance between links."""
    push_n: Positive = 25.0
    """Limit on the pull of the impedance. Against a measured force above it the pull is reduced further."""
    turn_n_m: Positive = 5.0
    """Limit on the torque of the impedance. Damped critically, the hand then turns with 1.5 rad/s at most."""
    touch_speed_m_s: Positive = 0.02
    """Speed at which the hand, or what it moves, may meet something: the first milliseconds of a blow precede any stop,
    so that only a slow approach keeps them below `contact_force_n`."""
    slow_down_s: Positive = 0.15
    """A gap of d (m) is closed with `touch_speed_m_s` + d / `slow_down_s` at most."""
    push_speed_m_s: Positive = 0.1
    """Speed at which what is touched may be pushed, once it is felt."""
    closing_gain: NonNegative = 2.0
    """Gain of the speed at which a gap is closed, as a share of the impedance's damping."""
    contact_force_n: Positive = 45.0
    """Largest contact force."""
    stop_share: Annotated[float, Field(gt=0, le=1)] = 0.8
    """Share of it at which the arm is stopped: until it rests, a slowly growing force keeps rising."""
    contact_torque_n_m: Positive = 12.0
    """A measured contact torque about the tool above it stops the arm."""


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
    """The link is lost if the arm's clock stands still for this long."""
    watchdog_s: Positive = 0.3
    """The stream stops the arm if the program shows no sign of life for this long. Planning and thinking are no
    silence: meanwhile the arm holds its last target."""
    limits: ArmLimitsCfg = field(default_factory=ArmLimitsCfg)
    """Limits of the arm."""
