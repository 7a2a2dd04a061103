"""From MAVLink messages to a report: a state that messages change and that a time reads. No sockets, no threads."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from typing import Any

from coral.reef.sea import ardusub
from coral.reef.sea.boot_clock import BootClock
from coral.reef.sea.frames import pose_from_ned, tilt_from_frd, velocity_from_ned
from coral.reef.sea.link import StatusText, VehicleReport
from coral.reef.sea.stations import NO_AUTOPILOT
from coral.reef.world.geometry import Pose, wrap

TEXTS = 64
RANGE_S = 1.0
"""A height older than this is none: the attitude that it is told with is a newer one."""
STICK_PWM = 30
"""A channel further from 1500 than this is a hand on the joystick."""


class Telemetry:
    """What the autopilot has said, about one vehicle."""

    def __init__(self, system: int = 0) -> None:
        """Listen to a system id (0: the first autopilot heard)."""
        self.system = system
        self.clock = BootClock()
        self.mode = ""
        self.armed = False
        self.kind = self.maker = 0
        self.version = 0
        self.autopilot = ""
        self.flags = 0
        self.malformed = 0
        """Messages with numbers that are not finite."""
        self.heartbeat_s = self.position_heard_s = -math.inf
        self.channels: tuple[int, ...] = ()
        self.channels_s = -math.inf
        self.foreign_stick_s = -math.inf
        self._pose: Pose | None = None
        self._velocity: tuple[float, float, float] | None = None
        self._tilt: tuple[float, float] | None = None
        self._yaw_ned: float | None = None
        self._yaw_rate = 0.0
        self._turned = 0.0
        self.depth_m: float | None = None
        """Below the surface."""
        self._range: tuple[float, float] = (math.nan, -math.inf)
        self._stamps = {"pose": -math.inf, "velocity": -math.inf, "attitude": -math.inf, "depth": -math.inf}
        self._test_ratio: float | None = None
        self._battery: tuple[float | None, float | None] = (None, None)
        self._leak = False
        self._texts: deque[StatusText] = deque(maxlen=TEXTS)
        self._chunks: dict[int, tuple[int, str]] = {}
        self._takes: dict[str, Callable[[Any, float], None]] = {
            "HEARTBEAT": self._heartbeat,
            "ATTITUDE": self._attitude,
            "LOCAL_POSITION_NED": self._position,
            "EKF_STATUS_REPORT": self._estimator,
            "VFR_HUD": self._depth_gauge,
            "DISTANCE_SENSOR": self._range_finder,
            "SYS_STATUS": self._system_status,
            "STATUSTEXT": self._text,
            "AUTOPILOT_VERSION": self._version,
            "RC_CHANNELS": self._channels_seen,
        }

    def take(self, message: Any, now: float) -> bool:
        """Take one message that came at `now` (monotonic s). Return whether it came from our autopilot."""
        name = message.get_type()
        source = (message.get_srcSystem(), message.get_srcComponent())
        if name == "HEARTBEAT" and source[1] == ardusub.AUTOPILOT_COMPONENT and message.autopilot != NO_AUTOPILOT:
            self.system = self.system or source[0]
        if source != (self.system, ardusub.AUTOPILOT_COMPONENT):
            if name in ("MANUAL_CONTROL", "RC_CHANNELS_OVERRIDE") and _addressed(message, self.system):
                self.foreign_stick_s = now
            return False
        take = self._takes.get(name)
        if take is not None:
            if _finite(message):
                take(message, now)
            else:
                self.malformed += 1
        return True

    def tell(self, severity: int, text: str) -> None:
        """Add a message of our own to those of the autopilot."""
        self._texts.append(StatusText(severity=severity, text=text))

    def motion(self, since_s: float) -> tuple[float | None, float | None]:
        """Return the forward speed (m/s) and the yaw rate (rad/s, left); None for what was measured before a time."""
        speed = None if self._velocity is None or self._stamps["velocity"] < since_s else self._velocity[0]
        return speed, None if self._stamps["attitude"] < since_s else -self._yaw_rate

    def _heartbeat(self, message: Any, now: float) -> None:
        self.heartbeat_s = now
        self.kind, self.maker = message.type, message.autopilot
        self.mode = ardusub.MODES.get(message.custom_mode, f"MODE {message.custom_mode}")
        self.armed = bool(message.base_mode & ardusub.ARMED_BIT)

    def _stamped(self, message: Any, name: str, now: float) -> float | None:
        """Return the stamp of a message, or None if a newer one has been taken."""
        reboots = self.clock.reboots
        stamp = self.clock.stamp(message.time_boot_ms / 1000.0, now)
        if self.clock.reboots != reboots:
            self._restarted()
        return None if stamp is None or stamp < self._stamps[name] else stamp

    def _restarted(self) -> None:
        self.flags = self.version = 0
        self._pose = self._velocity = None
        self._stamps = dict.fromkeys(self._stamps, -math.inf)
        self.tell(1, "coral: the autopilot restarted")

    def _attitude(self, message: Any, now: float) -> None:
        stamp = self._stamped(message, "attitude", now)
        if stamp is None:
            return
        self._stamps["attitude"] = stamp
        self._tilt = tilt_from_frd(message.roll, message.pitch)
        if self._yaw_ned is not None:
            self._turned -= wrap(message.yaw - self._yaw_ned)
        self._yaw_ned, self._yaw_rate = message.yaw, message.yawspeed

    def _position(self, message: Any, now: float) -> None:
        self.position_heard_s = now
        stamp = self._stamped(message, "pose", now)
        if stamp is None or self._yaw_ned is None:
            return
        if not ardusub.has_position(self.flags):
            return
        self._pose = pose_from_ned(message.x, message.y, self._yaw_ned)
        self._velocity = velocity_from_ned(message.vx, message.vy, self._yaw_ned, self._yaw_rate)
        self._stamps["pose"] = self._stamps["velocity"] = stamp

    def _estimator(self, message: Any, now: float) -> None:
        self.flags = message.flags
        self._test_ratio = max(message.velocity_variance, message.pos_horiz_variance)

    def _depth_gauge(self, message: Any, now: float) -> None:
        self.depth_m, self._stamps["depth"] = -message.alt, now

    def _range_finder(self, message: Any, now: float) -> None:
        """Take the height above the floor; ArduSub sends none as soon as its range finder has no data."""
        found = ardusub.range_down(message)
        if found is not None:
            self._range = (found, now)

    def _system_status(self, message: Any, now: float) -> None:
        volts = message.voltage_battery
        left = message.battery_remaining
        self._battery = (
            None if volts in (0, 65535) else volts / 1000.0,
            None if not 0 <= left <= 100 else left / 100.0,
        )

    def _text(self, message: Any, now: float) -> None:
        """Take a text; long ones come in chunks of 50 characters with a common id."""
        text = "".join(c for c in str(message.text).rstrip("\0") if c.isprintable())
        number = getattr(message, "id", 0)
        if number:
            position, before = self._chunks.get(number, (0, ""))
            text = before + text if message.chunk_seq == position else text
            if len(str(message.text)) == 50:
                self._chunks = {number: (message.chunk_seq + 1, text)}
                return
            self._chunks.pop(number, None)
        if text.lower().startswith("leak detected"):
            self._leak = True
        self.tell(message.severity, text)

    def _version(self, message: Any, now: float) -> None:
        first, self.version = self.version == 0, message.flight_sw_version
        self.autopilot = ardusub.version_text(self.version, bytes(message.flight_custom_version), self.maker, self.kind)
        warning = ardusub.version_warning(self.version)
        if first and warning:
            self.tell(4, f"coral: {warning}")

    def _channels_seen(self, message: Any, now: float) -> None:
        self.channels = tuple(getattr(message, f"chan{k}_raw") for k in range(1, 7))
        self.channels_s = now

    def stick_moved(self, ours: tuple[int, ...]) -> bool:
        """Check whether a channel that is not one of `ours` is off its centre.

        Channels: 0 pitch, 1 roll, 2 throttle, 3 yaw, 4 forward, 5 lateral.
        """
        return any(
            900 <= pwm <= 2100 and abs(pwm - 1500) > STICK_PWM for k, pwm in enumerate(self.channels) if k not in ours
        )

    def report(self, now: float, manual_override: bool = False) -> VehicleReport:
        """Return the state at `now` (monotonic s), with the texts since the last report."""
        texts, self._texts = tuple(self._texts), deque(maxlen=TEXTS)
        roll, pitch = self._tilt or (None, None)
        return VehicleReport(
            pose=self._pose,
            pose_stamp_s=self._stamps["pose"],
            has_position=ardusub.has_position(self.flags),
            position_test_ratio=self._test_ratio,
            roll_rad=roll,
            pitch_rad=pitch,
            yaw_rad=None if self._yaw_ned is None else wrap(math.pi / 2 - self._yaw_ned),
            attitude_stamp_s=self._stamps["attitude"],
            depth_m=self.depth_m,
            depth_stamp_s=self._stamps["depth"],
            altitude_m=self._range[0] if now - self._range[1] <= RANGE_S else None,
            altitude_stamp_s=self._range[1],
            velocity=self._velocity,
            velocity_stamp_s=self._stamps["velocity"],
            mode=self.mode,
            armed=self.armed,
            battery_v=self._battery[0],
            battery_fraction=self._battery[1],
            leak=self._leak,
            autopilot=self.autopilot,
            texts=texts,
            heartbeat_age_s=now - self.heartbeat_s,
            manual_override=manual_override,
            tether_turns=self._turned / (2 * math.pi),
            reboots=self.clock.reboots,
            clock_jumps=self.clock.jumps,
        )


def _addressed(message: Any, system: int) -> bool:
    return getattr(message, "target", getattr(message, "target_system", 0)) in (0, system)


def _finite(message: Any) -> bool:
    """Check the numbers of a message: a field with a NaN makes all of it doubtful."""
    values = (getattr(message, name) for name in message.get_fieldnames())
    return all(math.isfinite(value) for value in values if isinstance(value, float))
