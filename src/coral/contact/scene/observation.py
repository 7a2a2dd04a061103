"""Measurements, commands and true states: the values exchanged between a world and an episode.

Frames: world, metres, z up, the table's top at z = 0, x away from the robot. The tool frame lies midway between the
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
    """Measurements of the robot's sensors, and estimated poses of the objects."""

    time_s: float
    """Simulated time since reset."""
    tool: BodyState
    """The tool frame, from the robot's proprioception."""
    opening_m: float
    """Distance between the finger pads."""
    wrench: Array
    """Shape=(6,) force (N) and torque (N m) of the surroundings on the hand at the tool, world axes, without the hand's
    own weight."""
    objects: Mapping[str, BodyState]
    """Pose of every movable object, from the simulator or a tracker."""
    unseen: frozenset[str] = frozenset()
    """Objects that no picture has shown yet: their poses are guesses from the task file."""
    lost: frozenset[str] = frozenset()
    """Objects that the tracker has lost and the fingers do not hold: their poses are those last seen."""


@dataclass(frozen=True)
class HandTarget:
    """The target of the hand's impedance controller for the next control period."""

    position: Array
    """Shape=(3,) m of the tool frame."""
    quaternion: Array
    """Shape=(4,) of the tool frame."""
    opening_m: float
    """Commanded distance between the finger pads."""
    stiffness: float
    """Translational stiffness in N/m; the rotational one scales with it."""
    force: Array = field(default_factory=lambda: np.zeros(3))
    """Additional force, Shape=(3,) N, world axes."""


@dataclass(frozen=True)
class Contact:
    """A true contact between two named things: for the judge and for reports, never for decisions."""

    first: str
    """"hand", "left", "right" (finger), "robot" (the arm's other links), an object, or a fixture, such as "table"."""
    second: str
    """The other one; the two names are in alphabetical order."""
    force: Array
    """Force of the first on the second, Shape=(3,) N, world axes."""
    point: Array
    """Mean of the contact points, weighted by force, Shape=(3,) m."""


@dataclass(frozen=True)
class HandForce:
    """The hand's true force on an object over the last control step, all its physics steps counted."""

    mean: Array | None
    """Mean net force, Shape=(3,) N, world axes; None if the hand never touched the object in that time."""
    peak: float
    """Largest norm of the net force in a physics step (N)."""


@dataclass(frozen=True)
class Truth:
    """The state of the world for the judge: true in simulation, measured where nobody knows the truth."""

    time_s: float
    tool: BodyState
    opening_m: float
    objects: Mapping[str, BodyState]
    contacts: tuple[Contact, ...]
    hand_forces: Mapping[str, HandForce] = field(default_factory=dict)
    """By object; empty where the world does not measure it. A blow is shorter than a control step, and the contacts at
    the step's end miss it."""
    contacts_known: bool = True
    """False for a measured state: then `contacts` and `hand_forces` are empty for lack of knowledge."""


@dataclass(frozen=True)
class Transition:
    """One control step as the robot knows it."""

    before: Observation
    """Observation when the command was given."""
    command: HandTarget
    after: Observation
    """Observation at the end of the step."""
