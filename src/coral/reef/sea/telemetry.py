"""From MAVLink messages to a report: a state that messages change and that a time reads. No sockets, no threads."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from coral.reef.sea import ardusub
from coral.reef.sea.boot_clock import BootClock
from coral.reef.sea.frames import pose_from_ned, tilt_from_frd, velocity_from_ned
from coral.reef.sea.link import StatusText, VehicleReport
from coral.reef.world.geometry import wrap

TEXTS = 64
RANGE_S = 1.0
"""A height older than this is none: the attitude that it is told with is a newer one."""
STICK_PWM = 30
"""A channel further from 1500 than this is a hand on the joystick."""


class Telemetry:
    """What the autopilot has said, about one vehicle."""

    def __init__(self, system: int = 0) -> None:
        """Listen to a system id; 0: to nobody yet."""
        self.system = system
        self.clock = BootClock()
        self.said = VehicleReport()
        """What is known so far; `report` completes it."""
        self.version = 0
        self.heartbeat_s = self.position_heard_s = self.channels_s = self.foreign_stick_s = -math.inf
        self.channels: tuple[int, ...] = ()
        self._kind = self._maker = 0
        self._yaw_ned: float | None = None
        self._yaw_rate = 0.0
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
        if (message.get_srcSystem(), message.get_srcComponent()) != (self.system, ardusub.AUTOPILOT_COMPONENT):
            if name in ("MANUAL_CONTROL", "RC_CHANNELS_OVERRIDE") and _addressed(message, self.system):
                self.foreign_stick_s = now
            return False
        take = self._takes.get(name)
        if take is not None and _finite(message):
            take(message, now)
        return True

    def tell(self, severity: int, text: str) -> None:
        """Add a message of our own to those of the autopilot."""
        self._texts.append(StatusText(severity=severity, text=text))

    def _note(self, **values: Any) -> None:
        self.said = replace(self.said, **values)

    def _heartbeat(self, message: Any, now: float) -> None:
        self.heartbeat_s = now
        self._kind, self._maker = message.type, message.autopilot
        mode = ardusub.MODES.get(message.custom_mode, f"MODE {message.custom_mode}")
        self._note(mode=mode, armed=bool(message.base_mode & ardusub.ARMED_BIT))

    def _stamped(self, message: Any, name: str, now: float) -> float | None:
        """Return the stamp of a message, or None if a newer one has been taken."""
        reboots = self.clock.reboots
        stamp = self.clock.stamp(message.time_boot_ms / 1000.0, now)
        if self.clock.reboots != reboots:
            self._restarted()
        return None if stamp is None or stamp < getattr(self.said, f"{name}_stamp_s") else stamp

    def _restarted(self) -> None:
        self.version = 0
        never = dict.fromkeys(("pose_stamp_s", "velocity_stamp_s", "attitude_stamp_s", "depth_stamp_s"), -math.inf)
        self._note(pose=None, velocity=None, has_position=False, **never)
        self.tell(1, "coral: the autopilot restarted")

    def _attitude(self, message: Any, now: float) -> None:
        stamp = self._stamped(message, "attitude", now)
        if stamp is None:
            return
        roll, pitch = tilt_from_frd(message.roll, message.pitch)
        turned = 0.0 if self._yaw_ned is None else wrap(message.yaw - self._yaw_ned)
        self._note(
            roll_rad=roll,
            pitch_rad=pitch,
            yaw_rad=wrap(math.pi / 2 - message.yaw),
            attitude_stamp_s=stamp,
            tether_turns=self.said.tether_turns - turned / math.tau,
        )
        self._yaw_ned, self._yaw_rate = message.yaw, message.yawspeed

    def _position(self, message: Any, now: float) -> None:
        self.position_heard_s = now
        stamp = self._stamped(message, "pose", now)
        if stamp is None or self._yaw_ned is None or not self.said.has_position:
            return
        self._note(
            pose=pose_from_ned(message.x, message.y, self._yaw_ned),
            velocity=velocity_from_ned(message.vx, message.vy, self._yaw_ned, self._yaw_rate),
            pose_stamp_s=stamp,
            velocity_stamp_s=stamp,
        )

    def _estimator(self, message: Any, now: float) -> None:
        ratio = max(message.velocity_variance, message.pos_horiz_variance)
        self._note(has_position=ardusub.has_position(message.flags), position_test_ratio=ratio)

    def _depth_gauge(self, message: Any, now: float) -> None:
        self._note(depth_m=-message.alt, depth_stamp_s=now)

    def _range_finder(self, message: Any, now: float) -> None:
        """Take the height above the floor; ArduSub sends none as soon as its range finder has no data."""
        found = ardusub.range_down(message)
        if found is not None:
            self._note(altitude_m=found, altitude_stamp_s=now)

    def _system_status(self, message: Any, now: float) -> None:
        volts, left = message.voltage_battery, message.battery_remaining
        self._note(
            battery_v=None if volts in (0, 65535) else volts / 1000.0,
            battery_fraction=None if not 0 <= left <= 100 else left / 100.0,
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
            self._note(leak=True)
        self.tell(message.severity, text)

    def _version(self, message: Any, now: float) -> None:
        first, self.version = self.version == 0, message.flight_sw_version
        git = bytes(message.flight_custom_version)
        self._note(autopilot=ardusub.version_text(self.version, git, self._maker, self._kind))
        warning = ardusub.version_warning(self.version)
        if first and warning:
            self.tell(4, f"coral: {warning}")

    def _channels_seen(self, message: Any, now: float) -> None:
        self.channels = tuple(getattr(message, f"chan{k}_raw") for k in range(1, 7))
        self.channels_s = now

    def stick_moved(self) -> bool:
        """Check whether one of the pilot's channels is off its centre."""
        return any(900 <= pwm <= 2100 and abs(pwm - 1500) > STICK_PWM for pwm in self.channels)

    def report(self, now: float, manual_override: bool = False) -> VehicleReport:
        """Return the state at `now` (monotonic s), with the texts since the last report."""
        texts, self._texts = tuple(self._texts), deque(maxlen=TEXTS)
        return replace(
            self.said,
            altitude_m=self.said.altitude_m if now - self.said.altitude_stamp_s <= RANGE_S else None,
            texts=texts,
            heartbeat_age_s=now - self.heartbeat_s,
            manual_override=manual_override,
            reboots=self.clock.reboots,
            clock_jumps=self.clock.jumps,
        )


def _addressed(message: Any, system: int) -> bool:
    return getattr(message, "target", getattr(message, "target_system", 0)) in (0, system)


def _finite(message: Any) -> bool:
    """Check the numbers of a message: a field with a NaN makes all of it doubtful."""
    values = (getattr(message, name) for name in message.get_fieldnames())
    return all(math.isfinite(value) for value in values if isinstance(value, float))
