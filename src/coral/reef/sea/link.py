"""What the pilot's loop needs of a vehicle: one report of its state, one command, and four orders."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from coral.errors import RunError
from coral.reef.world.geometry import Pose


class LinkRefused(RunError):
    """The vehicle did not do what it was told. The text is the autopilot's own where it gave one."""


@dataclass(frozen=True, kw_only=True)
class StatusText:
    """One message of the autopilot to its operator."""

    severity: int
    """0 emergency, 1 alert, 2 critical, 3 error, 4 warning, 5 notice, 6 info, 7 debug (MAV_SEVERITY)."""
    text: str


@dataclass(frozen=True, kw_only=True)
class VehicleReport:
    """What is known of the vehicle now. World ENU, body FLU.

    Every stamp is the monotonic time (s, `time.monotonic`) at which a value was measured, as well as the link knows: a
    packet that comes late has an old stamp. It is -inf where nothing has come yet. Values are never dropped when they
    grow old: look at the stamps.
    """

    pose: Pose | None = None
    """Position and heading (m, m, rad) in the vehicle's own frame. None until the autopilot has a position."""
    pose_stamp_s: float = -math.inf
    """Stands still while the autopilot has no valid position, even if numbers still come."""
    has_position: bool = False
    """Whether the autopilot trusts its horizontal position now."""
    covariance: NDArray[np.float64] | None = None
    """Of the pose: x, y (m), theta (rad); None where it is not told, as by ArduSub. Shape=(3, 3)."""
    position_test_ratio: float | None = None
    """The estimator's innovation over its limit: near 0 is good, at 1 measurements are rejected. No covariance."""
    roll_rad: float | None = None
    """Positive raises the left side."""
    pitch_rad: float | None = None
    """Positive lowers the nose (REP-103)."""
    yaw_rad: float | None = None
    """Heading counter-clockwise from the x axis of the pose; known without a position, too."""
    attitude_stamp_s: float = -math.inf
    depth_m: float | None = None
    """Below the surface, positive down."""
    depth_stamp_s: float = -math.inf
    altitude_m: float | None = None
    """Height above the sea floor, as a range finder or a DVL measures it; None: unknown, or no longer."""
    altitude_stamp_s: float = -math.inf
    velocity: tuple[float, float, float] | None = None
    """Over ground, in the level body frame: m/s forward, m/s to the left, rad/s to the left."""
    velocity_stamp_s: float = -math.inf

    mode: str = ""
    """The autopilot's name for its mode, such as GUIDED or ALT_HOLD; "" until the first heartbeat."""
    armed: bool = False
    battery_v: float | None = None
    battery_fraction: float | None = None
    """Charge left, 0 to 1."""
    leak: bool = False
    """Water was detected inside the hull at some time since the link opened."""
    autopilot: str = ""
    """Name and version as reported, such as "ArduSub 4.7.0-dev (547e6101)"; "" while unknown."""
    identity_faults: tuple[str, ...] = ()
    """Why it is not certain who is on the link, such as a second vehicle of the same name. While there is
    a reason, the vehicle is not armed."""
    texts: tuple[StatusText, ...] = ()
    """Messages since the last report, oldest first."""
    heartbeat_age_s: float = math.inf
    """Since the vehicle's last heartbeat; inf before the first."""
    manual_override: bool = False
    """A pilot has taken over, by joystick or by a mode chosen elsewhere. Commands are not sent; `arm` ends it."""
    tether_turns: float = 0.0
    """Turns of the vehicle since the link opened, positive to the left: the twist of the tether."""
    reboots: int = 0
    """Restarts of the autopilot since the link opened. Poses before and after have no frame in common."""
    clock_jumps: int = 0
    """Jumps of the autopilot's clock that were no restart. Stamps are right again after each."""


class VehicleLink(Protocol):
    """A vehicle that can be driven. `report` and `command` never block; the orders may take seconds.

    The orders `arm`, `disarm`, `hold` and `surface` raise LinkRefused: the autopilot said no, with its words, or did
    not answer.
    """

    def report(self) -> VehicleReport:
        """Return the latest state."""

    def command(self, forward_m_s: float, yaw_rate_rad_s: float, depth_m: float) -> None:
        """Send one set-point, to be followed at most a few seconds if no other comes.

        The speed is over ground along the body's x axis, a positive yaw rate turns to the left, the depth is positive
        down. It is ignored while the vehicle is disarmed or taken over. Numbers that are not finite stop the vehicle.
        """

    def arm(self) -> None:
        """Take control: enter the driving mode and arm. Also the way back after a hold or an override."""

    def disarm(self) -> None:
        """Stop the thrusters."""

    def hold(self) -> None:
        """Stay where it is, by the autopilot's own means: POSHOLD with a position, ALT_HOLD without."""

    def surface(self) -> None:
        """Come up, by the autopilot's own means."""

    def close(self) -> None:
        """Stop sending and free the port. The vehicle stays as it is: its own failsafes act from here on."""
