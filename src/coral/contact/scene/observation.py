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
    """Pose and velocity of a rigid body in the world frame."""

    position: Array
    """Shape=(3,) m."""
    quaternion: Array
    """Shape=(4,)."""
    velocity: Array = field(default_factory=lambda: np.zeros(3))
    """Shape=(3,) m/s."""
    angular_velocity: Array = field(default_factory=lambda: np.zeros(3))
    """Shape=(3,) rad/s, world axes."""


@dataclass(frozen=True)
class Observation:
    """What the robot's sensors measure, and the estimated poses of the objects."""

    time_s: float
    """Simulated time since reset."""
    tool: BodyState
    """The tool frame, by the robot's proprioception."""
    opening_m: float
    """Distance between the finger pads."""
    wrench: Array
    """Shape=(6,) force (N) and torque (N m) that the surroundings exert on the hand at the tool, world axes, without
    the hand's own weight."""
    objects: Mapping[str, BodyState]
    """Pose of every movable object: the simulator's, or a tracker's."""


@dataclass(frozen=True)
class HandTarget:
    """The target of the hand's impedance controller for the next control period."""

    position: Array
    """Shape=(3,) m of the tool frame."""
    quaternion: Array
    """Shape=(4,) of the tool frame."""
    opening_m: float
    """Wanted distance between the finger pads."""
    stiffness: float
    """Translational stiffness in N/m; the rotational one scales with it."""
    force: Array = field(default_factory=lambda: np.zeros(3))
    """Shape=(3,) N pushed in addition, world axes."""
    torque: Array = field(default_factory=lambda: np.zeros(3))
    """Shape=(3,) N m turned with in addition, about the tool, world axes."""


@dataclass(frozen=True)
class Contact:
    """A true contact between two named things: for the judge and for reports, never for decisions."""

    first: str
    """"hand", "left", "right" (finger), "robot" (the arm's other links), an object, or a fixture, as "table"."""
    second: str
    """Likewise; names are in alphabetical order."""
    force: Array
    """Shape=(3,) N that the first exerts on the second, world axes."""
    point: Array
    """Shape=(3,) m, the contacts' mean weighted by force."""


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
    """One control step as the robot knows it."""

    before: Observation
    """Measured when the command was given."""
    command: HandTarget
    """What was commanded."""
    after: Observation
    """Measured at the end of the step."""
