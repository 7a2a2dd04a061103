"""What is measured, what is commanded, and what is true: the values that pass between a world and an episode.

Frames: world, metres, z up, the table's top at z = 0, x away from the robot. The tool frame sits midway between the
fingertips: z out of the palm, y along the fingers' opening. Quaternions are (w, x, y, z).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class BodyState:
    """Pose and velocity of a rigid body in the world frame.

    Args:
        position: Shape=(3,) m.
        quaternion: Shape=(4,).
        velocity: Shape=(3,) m/s.
        angular_velocity: Shape=(3,) rad/s, world axes.
    """

    position: Array
    quaternion: Array
    velocity: Array = field(default_factory=lambda: np.zeros(3))
    angular_velocity: Array = field(default_factory=lambda: np.zeros(3))


@dataclass(frozen=True)
class Observation:
    """What the robot's sensors measure, and the estimated poses of the objects.

    Args:
        time_s: Simulated time since reset.
        tool: The tool frame, by the robot's proprioception.
        opening_m: Distance between the finger pads.
        wrench: Shape=(6,) force (N) and torque (N m) that the surroundings exert on the hand at the tool, world axes,
            without the hand's own weight.
        objects: Pose of every movable object: the simulator's, or a tracker's.
    """

    time_s: float
    tool: BodyState
    opening_m: float
    wrench: Array
    objects: Mapping[str, BodyState]


@dataclass(frozen=True)
class HandTarget:
    """The target of the hand's impedance controller for the next control period.

    Args:
        position: Shape=(3,) m of the tool frame.
        quaternion: Shape=(4,) of the tool frame.
        opening_m: Wanted distance between the finger pads.
        stiffness: Translational stiffness in N/m; the rotational one scales with it.
        force: Shape=(3,) N pushed in addition, world axes.
        torque: Shape=(3,) N m turned with in addition, about the tool, world axes.
    """

    position: Array
    quaternion: Array
    opening_m: float
    stiffness: float
    force: Array = field(default_factory=lambda: np.zeros(3))
    torque: Array = field(default_factory=lambda: np.zeros(3))


@dataclass(frozen=True)
class Contact:
    """A true contact between two named things: for the judge and for reports, never for decisions.

    Args:
        first: "hand", "left", "right" (finger), "robot" (the arm's other links), an object, or a fixture, as "table".
        second: Likewise; names are in alphabetical order.
        force: Shape=(3,) N that the first exerts on the second, world axes.
        point: Shape=(3,) m, the contacts' mean weighted by force.
    """

    first: str
    second: str
    force: Array
    point: Array


@dataclass(frozen=True)
class Truth:
    """The true state of the world, for the judge."""

    time_s: float
    tool: BodyState
    opening_m: float
    objects: Mapping[str, BodyState]
    contacts: tuple[Contact, ...]


@dataclass(frozen=True)
class Transition:
    """One control step as the robot knows it.

    Args:
        before: Measured when the command was given.
        command: What was commanded.
        after: Measured at the end of the step.
    """

    before: Observation
    command: HandTarget
    after: Observation
