"""What a vehicle measures in one control period: the pilot's only input, in simulation and at sea."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from coral.reef.vehicle.range_image import RangeImage
from coral.reef.world.geometry import Frame, Pose

T = TypeVar("T")

Velocity = tuple[float, float, float]
"""Ground-relative surge, sway (m/s) and yaw rate (rad/s) in the body frame (FLU)."""


@dataclass(frozen=True)
class Stamped(Generic[T]):
    """A measurement and when it was made."""

    t: float
    """Time of the measurement (s), on the clock of the control loop."""
    value: T


HeardImage = Stamped[RangeImage]
"""A sonar's image at the time of its ping."""


@dataclass(frozen=True, kw_only=True)
class Attitude:
    """What is measured outside the plane."""

    roll: float
    """About body x (rad)."""
    pitch: float
    """About body y (rad); positive lowers the nose, as in REP-103."""
    depth_m: float
    """Depth below the surface (m)."""
    altitude_m: float | None = None
    """Height above the sea floor (m), as an altimeter or a Doppler log measures it; None: unknown."""


@dataclass(frozen=True, kw_only=True)
class VehicleObservation:
    """The newest measurements at one control tick.

    An input that did not arrive is None, or the last one again with its old stamp: sensors may be slower than the
    loop. `SensorGuard` checks everything before it is used, so a driver passes on what it received as it is.
    """

    t: float
    """Now (s), ten times a second, by a clock that only goes forward (`time.monotonic()`), as the stamps are."""
    pose: Stamped[Pose] | None = None
    """x, y, theta by odometry, world ENU: metres, radians counter-clockwise from east."""
    velocity: Stamped[Velocity] | None = None
    """u, v, r over ground, body FLU: m/s forward and to the left, rad/s to the left."""
    frame: Stamped[Frame] | None = None
    """The camera's picture, stamped with the time of exposure, not of arrival."""
    covariance: NDArray[np.float64] | None = None
    """Of the pose, in m and rad, Shape=(3, 3): a position that is not known to 2 m is refused. None: unknown."""
    attitude: Stamped[Attitude] | None = None
    """What is measured outside the plane."""
    sonar: Stamped[RangeImage] | None = None
    """Ranges in metres, inf where there is no echo, stamped with the time of the ping."""

    @classmethod
    def at(
        cls,
        t: float,
        pose: Pose,
        velocity: Velocity,
        frame: Frame,
        attitude: Attitude | None = None,
        sonar: RangeImage | None = None,
    ) -> VehicleObservation:
        """Observe everything at the same moment `t` (s), as a simulator does."""
        return cls(
            t=t,
            pose=Stamped(t, pose),
            velocity=Stamped(t, velocity),
            frame=Stamped(t, frame),
            attitude=None if attitude is None else Stamped(t, attitude),
            sonar=None if sonar is None else Stamped(t, sonar),
        )


class Vehicle(Protocol):
    """A vehicle that surveys. Neither method waits."""

    def observe(self, t: float) -> VehicleObservation:
        """Return the newest measurements at time `t` of the mission (s), in the survey's frame."""

    def command(self, command: tuple[float, float]) -> None:
        """Follow a forward speed (m/s) and a yaw rate (rad/s, positive to the left) until the next command."""
