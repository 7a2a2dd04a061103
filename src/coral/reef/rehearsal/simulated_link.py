"""The simulated vehicle in real time: our own dynamics behind the same interface as a real vehicle."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable

from coral.reef.sea.link import LinkRefused, StatusText, VehicleReport
from coral.reef.simulation.noise import PoseDrift
from coral.reef.vehicle.vehicle import Clearance, VehicleCfg, VehicleDynamics, VehicleState
from coral.reef.world.geometry import Pose, wrap

STEP_S = 0.02
"""The dynamics advance in steps of this length, as the autopilot's velocity loop does."""
LONGEST_S = 1.0
"""A pause of the process longer than this is not simulated: the vehicle stands still meanwhile."""
TIMEOUT_S = 3.0
"""A set-point holds for this long without another, as in ArduSub."""
HEARTBEAT_S = 1.0
ASCENT_M_S = 0.2
FULL_V, EMPTY_V = 16.4, 13.0
ENDURANCE_S = 7200.0
"""A full battery lasts two hours, as that of a BlueROV2 under light use."""


class SimulatedLink:
    """A vehicle that moves whenever it is asked where it is, up to the present time. Safe to use from any thread."""

    def __init__(
        self,
        cfg: VehicleCfg | None = None,
        start: Pose = Pose(0.0, 0.0, 0.0),  # noqa: B008
        *,
        depth_m: float = 1.0,
        drift: PoseDrift | None = None,
        altitude_m: float = 1.0,
        current: tuple[float, float] = (0.0, 0.0),
        contact: Clearance | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Put a vehicle into the water, disarmed, at a depth and a height above the sea floor (m).

        It reports the truth unless its pose drifts. `contact` is the signed distance (m) from a point to the nearest
        obstacle, which stops the hull.
        """
        self._vehicle = VehicleDynamics(cfg, VehicleState(*start))
        self._depth_m, self._current, self._contact, self._clock = depth_m, current, contact, clock
        self._drift = drift
        self._floor_m = depth_m + altitude_m
        self._lock = threading.RLock()
        self._began = self._now = clock()
        self._command = (0.0, 0.0)
        self._command_s = -math.inf
        self._armed, self._mode = False, "MANUAL"
        self._turned = 0.0
        self._texts: list[StatusText] = []
        self._closed = False
        self._pose = self._odometry(0.0)

    def true_pose(self) -> Pose:
        """Return where the vehicle is now. Only cameras and judges may know it."""
        with self._lock:
            self._advance()
            return Pose(*self._vehicle.state[:3])

    def report(self) -> VehicleReport:
        """Return the state now."""
        with self._lock:
            self._advance()
            now, depth_m = self._now, self._depth_m
            _, _, _, u, v, r = self._vehicle.state
            texts, self._texts = tuple(self._texts), []
            charge = max(0.0, 1.0 - (now - self._began) / ENDURANCE_S)
            return VehicleReport(
                pose=self._pose,
                pose_stamp_s=now,
                has_position=True,
                roll_rad=0.0,
                pitch_rad=0.0,
                yaw_rad=self._pose.theta,
                attitude_stamp_s=now,
                depth_m=depth_m,
                depth_stamp_s=now,
                altitude_m=self._floor_m - depth_m,
                velocity=(u, v, r),
                velocity_stamp_s=now,
                mode=self._mode,
                armed=self._armed,
                battery_v=EMPTY_V + charge * (FULL_V - EMPTY_V),
                battery_fraction=charge,
                autopilot="simulated vehicle",
                texts=texts,
                heartbeat_age_s=(now - self._began) % HEARTBEAT_S,
                tether_turns=self._turned / math.tau,
            )

    def command(self, forward_m_s: float, yaw_rate_rad_s: float, depth_m: float) -> None:
        """Follow a set-point for `TIMEOUT_S` at most; the depth is held as it is."""
        with self._lock:
            self._advance()
            finite = math.isfinite(forward_m_s) and math.isfinite(yaw_rate_rad_s)
            self._command = (forward_m_s, yaw_rate_rad_s) if finite else (0.0, 0.0)
            self._command_s = self._now

    def arm(self) -> None:
        """Arm and take commands."""
        self._enter("GUIDED", armed=True)

    def disarm(self) -> None:
        """Stop the thrusters."""
        self._enter(self._mode, armed=False)

    def hold(self) -> None:
        """Stay here."""
        self._enter("POSHOLD", armed=self._armed)

    def surface(self) -> None:
        """Come up."""
        self._enter("SURFACE", armed=self._armed)

    def close(self) -> None:
        """Forget the vehicle."""
        self._closed = True

    def _enter(self, mode: str, *, armed: bool) -> None:
        with self._lock:
            if self._closed:
                raise LinkRefused("the simulated vehicle is gone")
            self._advance()
            if (mode, armed) != (self._mode, self._armed):
                self._texts.append(StatusText(severity=6, text=f"{mode}, {'armed' if armed else 'disarmed'}"))
            self._mode, self._armed, self._command = mode, armed, (0.0, 0.0)

    def _advance(self) -> None:
        """Move the vehicle up to the present time."""
        now = self._clock()
        behind = now - self._now
        if behind > LONGEST_S:
            self._now = now - LONGEST_S
        while now - self._now >= STEP_S - 1e-9:
            driven = self._armed and self._mode == "GUIDED" and self._now - self._command_s <= TIMEOUT_S
            before = self._vehicle.state[2]
            self._vehicle.step(self._command if driven else (0.0, 0.0), STEP_S, self._current, self._contact)
            self._turned += wrap(self._vehicle.state[2] - before)
            if self._armed and self._mode == "SURFACE":
                self._depth_m = max(0.0, self._depth_m - ASCENT_M_S * STEP_S)
            self._now += STEP_S
            self._pose = self._odometry(STEP_S)

    def _odometry(self, dt: float) -> Pose:
        """Return the pose that it reports, `dt` seconds after the last time."""
        pose = Pose(*self._vehicle.state[:3])
        return pose if self._drift is None else self._drift.step(pose, dt)
