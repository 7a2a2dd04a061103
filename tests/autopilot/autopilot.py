"""A simulated autopilot: ArduSub's side of MAVLink over our own dynamics, stepped by a given time."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Any

from autopilot.body import Body
from autopilot.failsafes import Action, Circumstances, Failsafes
from autopilot.parameters import ParameterStore
from coral.config import Fraction, Positive, Signed, TimeStep
from coral.reef.sea import ardusub
from coral.reef.sea.ardusub import NEUTRAL
from coral.reef.world.geometry import Pose, wrap

POSITION_MODES = ("AUTO", "GUIDED", "CIRCLE", "POSHOLD")
RELIABLE = {0: 1.0}
"""Messages sent from the start, by period (s): the heartbeat."""
GUIDED_TIMEOUT_S = 3.0
LEAK_S = 3.0
"""A leak is forgotten this long after its last sign."""
EARTH_M = 6_378_137.0
EKF_GOOD, EKF_LOST, EKF_STANDING = 831, 37, 167
"""Flags as ArduSub's filter shows them: all well; the position lost; none yet."""
TURN_RAD_S, TURN_DEAD = 3.0, 0.05
"""Yaw rate of a full stick at full gain, and the share of the stick about its middle that turns nothing. ArduSub turned
at 0.06 and 0.15 rad/s with r = 145 and 200 at gain 0.5."""
DEAD_ZONE_M_S = 0.07
"""Climb rate that the throttle axis loses about its centre: z = 300 gave 0.13 m/s with ArduSub."""
REBOOT_WHILE_ARMED = 20190226.0
"""ArduPilot restarts an armed vehicle only if the sixth parameter of the order is this number."""
STICKS_S = 3.0
"""Joystick axes are forgotten after this time (RC_OVERRIDE_TIME)."""


@dataclass(frozen=True, kw_only=True)
class AutopilotCfg:
    """The simulated autopilot."""

    system: int = 1
    step_s: TimeStep = 0.05
    """The body moves in steps of this length."""
    position_after_s: float = 10.0
    """A position estimate comes this long after the boot (ArduSub in the loop: 20 to 60 s)."""
    dead_reckoning_s: float = 7.5
    """The estimator continues this long without measurements before it gives its position up, like ArduSub's."""
    boot_s: float = 2.0
    """Silence of a restart."""
    guided_share: Fraction = 0.85
    """Share of a wanted forward speed that GUIDED reaches. ArduSub in the loop: 0.85, 0.83, 0.84, 0.87
    at 0.2, 0.3, 0.5, 0.6 m/s after 6 s."""
    response_s: Positive = 0.5
    """Time constant with which a speed follows in modes that hold a position. ArduSub in the loop falls from 0.4 to
    0.1 m/s in 1.0 s in GUIDED and 1.7 s in POSHOLD."""
    latitude_deg: Signed = 43.0
    longitude_deg: Signed = -70.0
    """Origin of the estimator's frame: the world's (0, 0)."""
    volts_per_s: Positive = 1e-4
    """How fast the battery falls while armed."""


class SimulatedAutopilot:
    """ArduSub as far as the link sees it: modes, arming, set-points, failsafes, telemetry.

    `receive` takes bytes of a peer, `step` moves time, `send` returns the bytes for all peers. Nothing depends on the
    clock of the machine. The truth is `body`; the link sees only the telemetry.
    """

    def __init__(self, body: Body, cfg: AutopilotCfg | None = None, parameters: ParameterStore | None = None) -> None:
        self.cfg = cfg or AutopilotCfg()
        self.body = body
        self.parameters = parameters or ParameterStore()
        self.time_s = 0.0
        self._dialect = ardusub.load_dialect()
        self._codecs: dict[Hashable, Any] = {}
        self._writer = self._dialect.MAVLink(None, self.cfg.system, ardusub.AUTOPILOT_COMPONENT)
        self._out: list[bytes] = []
        self._left_s = 0.0
        self._boot()

    def _boot(self) -> None:
        self.booted_s = self.time_s
        self.clock_s = 0.0
        """The autopilot's time since boot, which faults may shift."""
        self.mode = "MANUAL"
        self.armed = False
        self.failsafes = Failsafes()
        self.seen = Circumstances(volts=self.parameters["SIM_BATT_VOLTAGE"])
        self._used_v = 0.0
        self._fix_s = -math.inf
        self._forward, self._followed_s = 0.0, -math.inf
        self._goal = (0.0, 0.0, 0.0)
        self._goal_s = -math.inf
        self._sticks, self._sticks_s = NEUTRAL, -math.inf
        self._channels = [1500] * 6
        self._periods: dict[int, float] = dict(RELIABLE)
        self._due: dict[int, float] = {}

    @property
    def has_position(self) -> bool:
        """Whether the estimator has a position."""
        recent = self.time_s - self._fix_s <= self.cfg.dead_reckoning_s
        return recent and self.time_s - self.booted_s >= self.cfg.position_after_s

    def reboot(self) -> None:
        """Restart: silent for a while, disarmed, clock at 0. Parameters stay."""
        self._boot()
        self.booted_s = self.time_s + self.cfg.boot_s

    def jump_clock(self, seconds: float) -> None:
        """Let the autopilot's clock jump, without a restart."""
        self.clock_s += seconds

    def leak(self, seconds: float = 0.0) -> None:
        """Let water in, for this long; it is forgotten a few seconds after its last sign."""
        self.seen.leak_until_s = self.time_s + max(seconds, LEAK_S)

    def choose(self, mode: str) -> None:
        """Enter a mode as if a pilot at another station had chosen it."""
        self._enter(mode)

    def send(self) -> bytes:
        """Return what has been sent since the last call."""
        data, self._out = b"".join(self._out), []
        return data

    def step(self, dt: float) -> None:
        """Move time by `dt` seconds, in steps of `cfg.step_s`; a remainder is kept for the next call."""
        self._left_s += dt
        while self._left_s >= self.cfg.step_s - 1e-9:
            self._left_s -= self.cfg.step_s
            self._advance(self.cfg.step_s)

    def _advance(self, dt: float) -> None:
        self.time_s += dt
        if self.time_s < self.booted_s:
            self.body.coast(dt)
            return
        self.clock_s += dt
        if self.parameters["SIM_GPS1_ENABLE"]:
            self._fix_s = self.time_s
        if self.armed:
            self._used_v += self.cfg.volts_per_s * dt
        self.seen.armed = self.armed
        self.seen.volts = self.parameters["SIM_BATT_VOLTAGE"] - self._used_v
        for verdict in self.failsafes.check(self.time_s, self.seen, self.parameters):
            if verdict.text:
                self._tell(verdict.severity, verdict.text)
            self._act(verdict.action)
        self._move(dt)
        self._publish()

    def _act(self, action: Action) -> None:
        if action == "disarm":
            self._disarm()
        elif action:
            self._enter("SURFACE" if action == "surface" else "ALT_HOLD")

    def _move(self, dt: float) -> None:
        """Let the mode drive the body."""
        body = self.body
        if self.time_s - self._sticks_s > STICKS_S:
            self._hold_sticks(NEUTRAL)
        x, _, z, r = self._sticks
        gain = self.parameters["JS_GAIN_DEFAULT"]
        turn = -math.copysign(TURN_RAD_S * max(gain * abs(r) / 1000.0 - TURN_DEAD, 0.0), r)
        climb = gain * (z - 500) / 500.0 * self.parameters["PILOT_SPEED_UP"] / 100.0
        climb = math.copysign(max(abs(climb) - DEAD_ZONE_M_S, 0.0), climb)
        if not self.armed:
            body.coast(dt)
        elif self.mode == "GUIDED":
            fresh = self.time_s - self._goal_s <= GUIDED_TIMEOUT_S
            forward, yaw_rate, down = self._goal if fresh else (0.0, 0.0, 0.0)
            self._follow(self.cfg.guided_share * forward, turn or yaw_rate, down, dt)
        elif self.mode == "SURFACE":
            self._follow(0.0, turn, -0.5, dt)
            if body.depth_m <= 0.1:
                self._enter("ALT_HOLD")
        elif self.mode == "POSHOLD":
            self._follow(0.0, turn, -climb, dt)
        elif self.mode == "ALT_HOLD":
            body.push(x / 1000.0 * gain, turn, -climb, dt)
        else:
            body.push(x / 1000.0 * gain, turn, 0.0 if z == 500 else -climb, dt)

    def _follow(self, forward: float, yaw_rate: float, down: float, dt: float) -> None:
        """Follow a velocity as the autopilot's controller does: with a lag."""
        if self._followed_s < self.time_s - 1.5 * dt:
            self._forward = self.body.velocity[0]
        self._followed_s = self.time_s
        self._forward += -math.expm1(-dt / self.cfg.response_s) * (forward - self._forward)
        self.body.swim(self._forward, yaw_rate, down, dt)

    def _enter(self, mode: str) -> bool:
        if mode in POSITION_MODES and not self.has_position:
            self._tell(4, f"Mode change failed: {mode.capitalize()} requires position")
            return False
        if mode != self.mode:
            self.mode = mode
            self._goal_s = -math.inf
            self._due[0] = self.time_s
        return True

    def _arm(self) -> bool:
        if self.seen.volts < self.parameters["BATT_ARM_VOLT"]:
            self._tell(2, "Arm: Battery 1 below minimum arming voltage")
            return False
        self.armed = True
        self.failsafes.low = False
        self._tell(6, "Arming motors")
        return True

    def _disarm(self) -> None:
        if self.armed:
            self.armed = False
            self._tell(6, "Disarming motors")

    # What comes in.

    def receive(self, data: bytes, peer: Hashable = 0) -> None:
        """Take bytes from one peer. Garbage is skipped; a restarting autopilot hears nothing."""
        codec = self._codecs.get(peer)
        if codec is None:
            codec = self._dialect.MAVLink(None, 0, 0)
            codec.robust_parsing = True
            self._codecs = {**dict(list(self._codecs.items())[-7:]), peer: codec}
        try:
            messages = codec.parse_buffer(data) or []
        except Exception:  # the codec promises not to raise; whatever a peer sends must not end the autopilot
            self._codecs.pop(peer)
            return
        if self.time_s < self.booted_s:
            return
        for message in messages:
            self._take(message)

    def _take(self, message: Any) -> None:
        name = message.get_type()
        if name == "BAD_DATA" or name.startswith("UNKNOWN"):
            return
        target = getattr(message, "target_system", getattr(message, "target", 0))
        if target not in (0, self.cfg.system):
            return
        take = getattr(self, f"_on_{name.lower()}", None)
        if take is not None and all(
            math.isfinite(v) for v in (getattr(message, f) for f in message.get_fieldnames()) if isinstance(v, float)
        ):
            take(message)

    def _from_gcs(self, message: Any) -> bool:
        return bool(message.get_srcSystem() == int(self.parameters["MAV_GCS_SYSID"]))

    def _on_heartbeat(self, message: Any) -> None:
        if self._from_gcs(message):
            self.seen.gcs_heard_s = self.time_s

    def _on_timesync(self, message: Any) -> None:
        if message.tc1 == 0:
            self._say(self._dialect.MAVLink_timesync_message(max(1, int(self.clock_s * 1e9)), message.ts1))

    def _on_param_request_read(self, message: Any) -> None:
        if 0 <= message.param_index < len(self.parameters.names):
            self._show(self.parameters.names[message.param_index])
        else:
            self._show(_text(message.param_id))

    def _on_param_request_list(self, message: Any) -> None:
        for name in self.parameters.names:
            self._show(name)

    def _on_param_set(self, message: Any) -> None:
        name = _text(message.param_id)
        self.parameters.write(name, message.param_value)
        self._show(name)

    def _show(self, name: str) -> None:
        if name in self.parameters.values:
            index = self.parameters.names.index(name)
            self._say(
                self._dialect.MAVLink_param_value_message(
                    name.encode(), self.parameters[name], 9, len(self.parameters.names), index
                )
            )

    def _on_command_long(self, message: Any) -> None:
        self._command(message, message.param1, message.param2)

    def _on_command_int(self, message: Any) -> None:
        self._command(message, message.param1, message.param2)

    def _command(self, message: Any, first: float, second: float) -> None:
        m = self._dialect
        orders: dict[int, Callable[[float, float], int]] = {
            m.MAV_CMD_DO_SET_MODE: self._do_set_mode,
            m.MAV_CMD_COMPONENT_ARM_DISARM: self._do_arm,
            m.MAV_CMD_SET_MESSAGE_INTERVAL: self._do_interval,
            m.MAV_CMD_REQUEST_MESSAGE: self._do_request,
            m.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN: lambda what, _: self._do_reboot(what, getattr(message, "param6", 0.0)),
        }
        order = orders.get(message.command)
        before, self._out = self._out, []
        result = m.MAV_RESULT_UNSUPPORTED if order is None else order(first, second)
        words, self._out = self._out, before  # ArduSub acknowledges first and explains then
        acknowledge = m.MAVLink_command_ack_message(
            message.command, result, 0, 0, message.get_srcSystem(), message.get_srcComponent()
        )
        self._say(acknowledge)
        self._out += words
        if message.command == m.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN and result == m.MAV_RESULT_ACCEPTED:
            self.reboot()

    def _do_set_mode(self, flags: float, number: float) -> int:
        mode = ardusub.MODES.get(int(number))
        if mode is None:
            self._tell(4, f"No such mode {int(number)}")
        return 0 if mode is not None and self._enter(mode) else 4

    def _on_set_mode(self, message: Any) -> None:
        self._do_set_mode(1.0, message.custom_mode)

    def _do_arm(self, arm: float, _: float) -> int:
        if arm not in (0.0, 1.0):
            return 3
        if arm:
            return 0 if self.armed or self._arm() else 4
        self._disarm()
        return 0

    def _do_interval(self, number: float, interval_us: float) -> int:
        if int(number) not in self._messages():
            return 2
        if interval_us < 0:
            self._periods.pop(int(number), None)
        else:
            self._periods[int(number)] = max(interval_us * 1e-6, self.cfg.step_s) if interval_us else 1.0
        return 0

    def _do_request(self, number: float, _: float) -> int:
        message = self._messages().get(int(number), lambda: None)()
        if message is None:
            return 4
        self._say(message)
        return 0

    def _do_reboot(self, what: float, force: float) -> int:
        return 0 if what == 1.0 and (not self.armed or force == REBOOT_WHILE_ARMED) else 4

    def _on_set_position_target_local_ned(self, message: Any) -> None:
        if self.mode != "GUIDED" or message.coordinate_frame not in (8, 9, 12):
            return
        mask = message.type_mask
        if mask & 7 != 7 or mask & 0b111000 or mask & 0x1C0 != 0x1C0:
            return
        yaw_rate = 0.0 if mask & 0x800 else -message.yaw_rate
        limit = self.parameters["WPNAV_SPEED"] / 100.0
        forward = min(max(message.vx, -limit), limit)
        self._goal, self._goal_s = (forward, yaw_rate, min(max(message.vz, -limit), limit)), self.time_s

    def _on_manual_control(self, message: Any) -> None:
        if not self._from_gcs(message) or message.target != self.cfg.system:
            return
        self.seen.pilot_heard_s = self.time_s
        bounds = ((-1000, 1000), (-1000, 1000), (0, 1000), (-1000, 1000))
        values = (message.x, message.y, message.z, message.r)
        if all(low <= value <= high for value, (low, high) in zip(values, bounds, strict=True)):
            self._sticks_s = self.time_s
            self._hold_sticks(values)

    def _hold_sticks(self, sticks: tuple[int, int, int, int]) -> None:
        self._sticks = sticks
        scale = 0.4 * self.parameters["JS_GAIN_DEFAULT"]
        x, y, z, r = sticks
        self._channels = [round(1500 + scale * axis) for axis in (0, 0, 2 * (z - 500), r, x, y)]

    def _on_sys_status(self, message: Any) -> None:
        water = 0x20000000
        if message.onboard_control_sensors_enabled & water and not message.onboard_control_sensors_health & water:
            self.leak()

    # What goes out.

    def _say(self, message: Any) -> None:
        self._out.append(bytes(message.pack(self._writer)))
        self._writer.seq = (self._writer.seq + 1) % 256

    def _tell(self, severity: int, text: str) -> None:
        self._say(self._dialect.MAVLink_statustext_message(severity, text.encode()[:50]))

    def _publish(self) -> None:
        for number, period in sorted(self._periods.items()):
            if self.time_s >= self._due.get(number, -math.inf) - 1e-9:
                self._due[number] = max(self._due.get(number, self.time_s), self.time_s - period) + period
                message = self._messages()[number]()
                if message is not None:
                    self._say(message)

    def _messages(self) -> dict[int, Any]:
        return {
            0: self._heartbeat,
            1: self._system_status,
            30: self._attitude,
            32: self._local_position,
            49: self._origin,
            65: self._rc_channels,
            74: self._hud,
            108: self._truth,
            148: self._version,
            193: self._estimator,
        }

    def _boot_ms(self) -> int:
        return max(0, round(self.clock_s * 1000.0)) % 2**32

    def _heartbeat(self) -> Any:
        mode = 81 + (8 if self.mode in POSITION_MODES else 0) + (128 if self.armed else 0)
        status = 5 if self.failsafes.lost_gcs else 4 if self.armed else 3
        return self._dialect.MAVLink_heartbeat_message(
            ardusub.SUBMARINE, 3, mode, ardusub.NUMBERS[self.mode], status, 3
        )

    def _system_status(self) -> Any:
        volts = max(0, round(self.seen.volts * 1000.0))
        left = round(min(max((self.seen.volts - 10.5) / 2.1, 0.0), 1.0) * 100.0)
        return self._dialect.MAVLink_sys_status_message(0, 0, 0, 0, min(volts, 65534), 0, left, 0, 0, 0, 0, 0, 0)

    def _attitude(self) -> Any:
        _, _, yaw = pose_to_ned(self.body.pose)
        return self._dialect.MAVLink_attitude_message(self._boot_ms(), 0.0, 0.0, yaw, 0.0, 0.0, -self.body.velocity[2])

    def _local_position(self) -> Any:
        if self._fix_s == -math.inf or self.time_s - self.booted_s < self.cfg.position_after_s:
            return None
        north, east, yaw = pose_to_ned(self.body.pose)
        vn, ve, _ = velocity_to_ned(self.body.velocity, yaw)
        return self._dialect.MAVLink_local_position_ned_message(
            self._boot_ms(), north, east, self.body.depth_m, vn, ve, self.body.down_m_s
        )

    def _hud(self) -> Any:
        u, v, _ = self.body.velocity
        heading = round(math.degrees(pose_to_ned(self.body.pose)[2])) % 360
        return self._dialect.MAVLink_vfr_hud_message(
            0.0, math.hypot(u, v), heading, 0, -self.body.depth_m, -self.body.down_m_s
        )

    def _estimator(self) -> Any:
        ready = self.time_s - self.booted_s >= self.cfg.position_after_s and self._fix_s > -math.inf
        flags = EKF_GOOD if self.has_position else EKF_LOST if ready else EKF_STANDING
        return self._dialect.MAVLink_ekf_status_report_message(flags, 0.01, 0.01, 0.02, 0.01, 0.0)

    def _rc_channels(self) -> Any:
        return self._dialect.MAVLink_rc_channels_message(self._boot_ms(), 8, *self._channels, 1500, 1500, *[0] * 10, 0)

    def _origin(self) -> Any:
        if self._fix_s == -math.inf or self.time_s - self.booted_s < self.cfg.position_after_s:
            return None
        latitude, longitude = (round(d * 1e7) for d in (self.cfg.latitude_deg, self.cfg.longitude_deg))
        return self._dialect.MAVLink_gps_global_origin_message(latitude, longitude, 0, int(self.clock_s * 1e6))

    def _truth(self) -> Any:
        """SIM_STATE, as ArduPilot's simulations send it: for a camera double, and never read by the link."""
        north, east, yaw = pose_to_ned(self.body.pose)
        latitude = self.cfg.latitude_deg + math.degrees(north / EARTH_M)
        longitude = self.cfg.longitude_deg + math.degrees(
            east / EARTH_M / math.cos(math.radians(self.cfg.latitude_deg))
        )
        vn, ve, _ = velocity_to_ned(self.body.velocity, yaw)
        return self._dialect.MAVLink_sim_state_message(
            math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2), 0.0, 0.0, yaw, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
            latitude, longitude, -self.body.depth_m, 0.0, 0.0, vn, ve, self.body.down_m_s,
            round(latitude * 1e7), round(longitude * 1e7),
        )  # fmt: skip

    def _version(self) -> Any:
        return self._dialect.MAVLink_autopilot_version_message(
            0, 0x04070000, 0, 0, 0, list(b"coralsim"), [0] * 8, [0] * 8, 0, 0, 0
        )


def pose_to_ned(pose: Pose) -> tuple[float, float, float]:
    """Convert an ENU pose to (north m, east m, yaw rad): the inverse of `pose_from_ned`."""
    return pose.y, pose.x, wrap(math.pi / 2 - pose.theta)


def velocity_to_ned(velocity: tuple[float, float, float], yaw_rad: float) -> tuple[float, float, float]:
    """Convert a velocity in FLU to (m/s north, m/s east, rad/s clockwise): the inverse of `velocity_from_ned`."""
    forward, left, turn = velocity
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    return c * forward + s * left, s * forward - c * left, -turn


def _text(value: Any) -> str:
    return (value.decode("ascii", "replace") if isinstance(value, bytes) else str(value)).rstrip("\0")
