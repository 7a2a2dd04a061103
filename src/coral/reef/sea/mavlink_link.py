"""The link to a BlueROV2: MAVLink with ArduSub, or with the simulated autopilot, which speaks the same."""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from collections.abc import Callable, Hashable
from dataclasses import replace
from typing import Any

from coral.reef.sea import ardusub
from coral.reef.sea.link import LinkRefused, VehicleReport
from coral.reef.sea.stations import MOST, Stations, place
from coral.reef.sea.telemetry import Telemetry
from coral.reef.sea.transport import Transport, VehicleAddress, open_transport

STREAMS = {30: 20.0, 32: 20.0, 74: 10.0, 193: 5.0, 1: 2.0, 65: 10.0, 132: 10.0}
"""Messages asked for, per second: ATTITUDE, LOCAL_POSITION_NED, VFR_HUD, EKF_STATUS_REPORT, SYS_STATUS, RC_CHANNELS,
DISTANCE_SENSOR."""
POLL_S = 0.02
"""The line is read for this long at a time."""
SET_MESSAGE_INTERVAL, REQUEST_MESSAGE, SET_MODE, ARM_DISARM = 511, 512, 176, 400
AUTOPILOT_VERSION = 148
ACCEPTED, IN_PROGRESS = 0, 5
STREAMS_KEPT = MOST + 1
"""This many senders have a decoder."""
OWN_SYSTEM = 255
"""Our system id. ArduSub takes joystick axes from MAV_GCS_SYSID alone (255), and counts its heartbeats."""
OWN_COMPONENT = 191
"""MAV_COMP_ID_ONBOARD_COMPUTER: with the same system id, QGroundControl is component 190."""
HEARTBEAT_S = 0.5
"""Period of our heartbeats. ArduSub's failsafe acts after 5 s without (FS_GCS_TIMEOUT)."""
NEUTRAL_S = 0.5
"""Period of neutral joystick axes, so that the failsafe of the pilot's input (3 s) rests."""
ASK_AGAIN_S = 2.0
"""Messages that do not come are asked for again so often."""
ANSWER_S = 1.0
"""An order is repeated when there is no answer for this long."""
TRIES = 3
SETTLE_S = 3.0
"""A mode, or the motors, must be seen as ordered within this time."""
WORDS_S = 0.3
"""Longest wait for the autopilot's words after a refusal."""
RESULTS = {1: "temporarily rejected", 2: "denied", 3: "unsupported", 4: "failed", 6: "cancelled"}
"""MAV_RESULT in words, where the autopilot gives none of its own."""


class MavlinkLink:
    """A `VehicleLink` over MAVLink: a thread reads, keeps heartbeats and streams alive; commands go out at once.

    `arm` enters GUIDED, which needs a position estimate, and commands are body-frame velocities with a yaw rate. Only
    orders change the mode, with one exception: when a joystick moves in GUIDED, the link leaves it for POSHOLD, where
    the stick steers.
    """

    def __init__(
        self, address: VehicleAddress | Transport, clock: Callable[[], float] = time.monotonic, threaded: bool = True
    ) -> None:
        """Open the line and begin to listen; `clock` is monotonic (s).

        Without `threaded`, `poll` has to be called, and orders call it while they wait.

        Raises:
            InputError: The address cannot be used, or pymavlink is missing.
        """
        self._dialect = ardusub.load_dialect()
        self._line = open_transport(address) if isinstance(address, VehicleAddress) else address
        self._clock = clock
        self._lock = threading.RLock()
        self._heard = threading.Condition(self._lock)
        self._codecs: dict[Hashable, Any] = {}
        self._out = self._dialect.MAVLink(None, OWN_SYSTEM, OWN_COMPONENT)
        system = address.system if isinstance(address, VehicleAddress) else 0
        self.telemetry = Telemetry(system)
        self._stations = Stations(system)
        self._warned: tuple[str, ...] = ()
        self._charge = self._driving = False  # in charge since `arm`; driving until the next order
        self._ordered = ""
        self._ordered_s = -math.inf
        self._override = False
        self._acks: dict[int, int] = {}
        self._words: deque[str] = deque(maxlen=20)
        self._reboots = 0
        self._beat_s = self._stick_s = self._asked_s = self._synced_s = -math.inf
        self._sync_sent: dict[int, float] = {}
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._run, name="mavlink", daemon=True) if threaded else None
        if self._thread is not None:
            self._thread.start()

    def report(self) -> VehicleReport:
        """Return the latest state."""
        with self._lock:
            now = self._clock()
            report = self.telemetry.report(now, self._override)
            return replace(report, identity_faults=self._stations.faults(now))

    def command(self, forward_m_s: float, yaw_rate_rad_s: float, depth_m: float) -> None:
        """Send one set-point; see `VehicleLink.command`."""
        if not (math.isfinite(forward_m_s) and math.isfinite(yaw_rate_rad_s)):
            forward_m_s = yaw_rate_rad_s = 0.0
        with self._lock:
            said = self.telemetry.said
            if self._driving and not self._override and said.armed:
                self._send_velocity(forward_m_s, yaw_rate_rad_s, ardusub.climb_rate(said.depth_m, depth_m))

    def _send_velocity(self, forward_m_s: float, yaw_rate_rad_s: float, down_m_s: float) -> None:
        system, frame = self.telemetry.system, self._dialect.MAV_FRAME_BODY_OFFSET_NED
        self._send(
            self._dialect.MAVLink_set_position_target_local_ned_message(
                0, system, ardusub.AUTOPILOT_COMPONENT, frame, ardusub.VELOCITY_AND_YAW_RATE, 0.0, 0.0, 0.0,
                forward_m_s, 0.0, down_m_s, 0.0, 0.0, 0.0, 0.0, -yaw_rate_rad_s,
            )
        )  # fmt: skip

    def arm(self) -> None:
        """Enter GUIDED and arm; see `VehicleLink.arm`."""
        with self._lock:
            state = self.telemetry
            if state.heartbeat_s == -math.inf:
                raise LinkRefused("no autopilot has been heard")
            faults = self._stations.faults(self._clock())
            if faults:
                raise LinkRefused(f"not armed: {'; '.join(faults)}")
            if not state.said.has_position:
                raise LinkRefused("not armed: the autopilot has no position")
        self._enter("GUIDED")
        self._stick(self._clock())  # the failsafe of the pilot's input would disarm a vehicle that never had any
        self._tell_motors(True)
        with self._lock:
            self._override, self._charge, self._driving = False, True, True
            state.channels = ()
            state.foreign_stick_s = -math.inf

    def disarm(self) -> None:
        """Stop the thrusters; see `VehicleLink.disarm`."""
        with self._lock:
            self._charge = self._driving = False
        self._tell_motors(False)

    def hold(self) -> None:
        """Enter POSHOLD (ALT_HOLD without a position); see `VehicleLink.hold`."""
        with self._lock:
            self._driving = False
        self._enter(self._holding_mode())

    def surface(self) -> None:
        """Enter SURFACE; see `VehicleLink.surface`."""
        with self._lock:
            self._driving = False
        self._enter("SURFACE")

    def close(self) -> None:
        """Stop sending and free the port."""
        self._closed.set()
        if self._thread is not None and threading.current_thread() is not self._thread:
            self._thread.join(timeout=2.0)
        self._line.close()

    def _enter(self, mode: str) -> None:
        with self._lock:
            self._ordered, self._ordered_s = mode, self._clock()
        self._order(SET_MODE, (1.0, float(ardusub.NUMBERS[mode])), f"mode {mode}")
        self._await(lambda: self.telemetry.said.mode == mode, f"mode {mode}")

    def _tell_motors(self, armed: bool) -> None:
        what = "arming" if armed else "disarming"
        if self.telemetry.said.armed != armed:
            self._order(ARM_DISARM, (float(armed), 0.0), what)
            self._await(lambda: self.telemetry.said.armed == armed, what)

    def _order(self, command: int, parameters: tuple[float, float], what: str) -> None:
        """Send a command until it is acknowledged.

        Raises:
            LinkRefused: It was refused, or nobody answered.
        """
        with self._heard:
            self._words.clear()
            for attempt in range(TRIES):
                self._acks.pop(command, None)
                self._send(self._long(command, *parameters, confirmation=attempt))
                if self._wait(lambda: self._acks.get(command, IN_PROGRESS) != IN_PROGRESS, ANSWER_S):
                    break
            else:
                raise LinkRefused(f"{what}: the autopilot did not answer")
            result = self._acks[command]
            if result != ACCEPTED:
                self._wait(lambda: False, WORDS_S)
                reason = "; ".join(dict.fromkeys(self._words)) or RESULTS.get(result, f"result {result}")
                raise LinkRefused(f"{what} refused: {reason}")

    def _await(self, done: Callable[[], bool], what: str) -> None:
        with self._heard:
            if not self._wait(done, SETTLE_S):
                raise LinkRefused(f"{what} was acknowledged but did not come")

    def _long(self, command: int, *parameters: float, confirmation: int = 0) -> Any:
        padded = (*parameters, *[0.0] * (7 - len(parameters)))
        return self._dialect.MAVLink_command_long_message(
            self.telemetry.system, ardusub.AUTOPILOT_COMPONENT, command, confirmation, *padded
        )

    def _send(self, message: Any) -> None:
        with self._lock:
            self._line.send(message.pack(self._out))
            self._out.seq = (self._out.seq + 1) % 256

    def poll(self) -> None:
        """Take what has come, and send what is due. The thread does nothing else."""
        data = self._line.receive(POLL_S)
        with self._heard:
            now = self._clock()
            sender = self._line.sender
            for message in self._parse(data, sender):
                self._take(message, sender, now)
            self._watch(now)
            self._keep_alive(now)
            if data:
                self._heard.notify_all()

    def _run(self) -> None:
        while not self._closed.is_set():
            self.poll()

    def _wait(self, done: Callable[[], bool], seconds: float) -> bool:
        """Wait until something holds, at most this long. Return whether it does. The lock is held."""
        if self._thread is not None:
            return self._heard.wait_for(done, seconds)
        until = self._clock() + seconds
        while not done() and self._clock() < until:
            self.poll()
        return done()

    def _parse(self, data: bytes, sender: Hashable) -> list[Any]:
        """Decode what is valid and skip garbage. Each sender has a stream of its own: none garbles another's."""
        if not data:
            return []
        codec = self._codecs.pop(sender, None)
        if codec is None:
            codec = self._dialect.MAVLink(None, OWN_SYSTEM, OWN_COMPONENT)
            codec.robust_parsing = True
        try:
            messages = codec.parse_buffer(data) or []
        except Exception:  # the codec promises not to raise in robust mode; a bad line must not end the thread
            return []
        self._codecs[sender] = codec
        while len(self._codecs) > STREAMS_KEPT:
            del self._codecs[next(iter(self._codecs))]
        return messages

    def _take(self, message: Any, sender: Hashable, now: float) -> None:
        name = message.get_type()
        if name.startswith(("BAD_DATA", "UNKNOWN")):
            return
        unknown = self._stations.vehicle is None
        if not self._stations.take(message, sender, now):
            return
        if unknown and self._stations.vehicle is not None:
            self.telemetry.system = self._stations.vehicle.system
            self._line.answer(sender)
        if not self.telemetry.take(message, now):
            return
        if name == "COMMAND_ACK" and message.target_system in (0, OWN_SYSTEM):
            if getattr(message, "target_component", 0) in (0, OWN_COMPONENT):
                self._acks[message.command] = message.result
                self._stations.answered()
        elif name == "STATUSTEXT":
            self._words.append(str(message.text).rstrip("\0"))
        elif name == "TIMESYNC" and message.tc1 and message.ts1 in self._sync_sent:
            self._stations.answered()
            self.telemetry.clock.synchronise(self._sync_sent.pop(message.ts1), message.tc1 * 1e-9, now)

    def _watch(self, now: float) -> None:
        """See who else speaks, and who else gives orders."""
        state = self.telemetry
        if self._stations.moved(now):
            assert self._stations.vehicle is not None
            self._line.answer(self._stations.vehicle.peer)
            self._let_go()
            state.tell(2, f"coral: the vehicle speaks from {place(self._stations.vehicle.peer)} now; arm again")
        faults = self._stations.faults(now) if self._charge else ()
        for fault in faults:
            if fault not in self._warned:
                state.tell(2, f"coral: {fault}")
        self._warned = faults
        if state.clock.reboots != self._reboots:
            self._reboots = state.clock.reboots
            self._let_go()
        if not self._charge or self._override:
            return
        settled = state.heartbeat_s > self._ordered_s + 1.0
        if (self._ordered, state.said.mode) == ("SURFACE", "ALT_HOLD"):
            self._ordered = "ALT_HOLD"  # ArduSub's own end of SURFACE
        if settled and state.said.mode != self._ordered:
            self._taken_over(f"mode {state.said.mode} was chosen elsewhere")
        elif state.foreign_stick_s > self._ordered_s or (
            state.channels_s > self._ordered_s + 0.5 and state.stick_moved()
        ):
            self._taken_over("the joystick moved")
            self._hand_over()
        elif settled and not state.said.armed:
            self._charge = self._driving = False

    def _let_go(self) -> None:
        """Be in charge of nothing, and ask for messages again."""
        self._charge = self._driving = False
        self._asked_s, self._ordered = -math.inf, ""

    def _taken_over(self, why: str) -> None:
        self._override = True
        self.telemetry.tell(4, f"coral: {why}; commands stop until the operator arms again")

    def _hand_over(self) -> None:
        """Leave GUIDED for a mode in which the joystick steers: GUIDED takes only its yaw, and continues for 3 s."""
        if self._ordered == "GUIDED":
            self._send_velocity(0.0, 0.0, 0.0)
            self._send(self._long(SET_MODE, 1.0, float(ardusub.NUMBERS[self._holding_mode()])))

    def _holding_mode(self) -> str:
        return "POSHOLD" if self.telemetry.said.has_position else "ALT_HOLD"

    def _keep_alive(self, now: float) -> None:
        """Send what is due: heartbeat, time synchronisation, requests, neutral axes."""
        m, state = self._dialect, self.telemetry
        if now - self._beat_s >= HEARTBEAT_S:
            self._beat_s = now
            self._send(
                m.MAVLink_heartbeat_message(m.MAV_TYPE_GCS, m.MAV_AUTOPILOT_INVALID, 0, 0, m.MAV_STATE_ACTIVE, 3)
            )
        if not state.system:
            return
        if now - self._synced_s >= 1.0:
            self._synced_s = now
            key = int(now * 1e9)
            self._sync_sent = {**dict(list(self._sync_sent.items())[-4:]), key: now}
            self._send(m.MAVLink_timesync_message(0, key))
        silent = now - state.position_heard_s > 1.0 or now - state.channels_s > 1.0 or not state.version
        if silent and now - self._asked_s >= ASK_AGAIN_S:
            self._asked_s = now
            for number, rate in STREAMS.items():
                self._send(self._long(SET_MESSAGE_INTERVAL, float(number), 1e6 / rate))
            self._send(self._long(REQUEST_MESSAGE, float(AUTOPILOT_VERSION)))
        if self._charge and not self._override and state.said.armed and now - self._stick_s >= NEUTRAL_S:
            self._stick(now)

    def _stick(self, now: float) -> None:
        """Send neutral axes."""
        self._stick_s = now
        self._send(self._dialect.MAVLink_manual_control_message(self.telemetry.system, *ardusub.NEUTRAL, 0))
