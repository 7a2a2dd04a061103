"""Faults of the link and of the autopilot: what happened, and after how many seconds. A Markdown table.

Usage: python benchmarks/link_faults.py [--vehicle simulated|mavlink:tcp:127.0.0.1:5760] [--only WORDS] [--json FILE]

Each row begins with the vehicle under way at 0.4 m/s, set-points at 10 Hz. The seconds count from the fault: until the
report of the link showed it, and until the vehicle had reacted. The same code drives both autopilots; parameters named
SIM_ are ArduPilot's own for simulations. Nothing here may be run against a vehicle in the water.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from autopilot.autopilot import AutopilotCfg, SimulatedAutopilot
from autopilot.body import Body, OpenWater
from autopilot.server import AutopilotServer
from coral.reef.sea.address import parse_address
from coral.reef.sea.ardusub import load_dialect
from coral.reef.sea.link import LinkRefused, VehicleReport
from coral.reef.sea.mavlink_link import MavlinkLink
from coral.reef.sea.transport import open_transport

SPEED_M_S = 0.4
DEPTH_M = 1.0
mavlink = load_dialect()


class BadLine:
    """A `Transport` that can be cut, lossy, late or noisy."""

    def __init__(self, line) -> None:
        self.line = line
        self.cut, self.loss, self.delay_s, self.noise = False, 0.0, 0.0, False
        self.rng = np.random.default_rng(0)
        self.waiting: list[tuple[float, bytes]] = []

    def receive(self, timeout_s: float) -> bytes:
        """Return what is not lost and not late."""
        data, now = self.line.receive(timeout_s), time.monotonic()
        if data and not (self.cut or self.rng.random() < self.loss):
            self.waiting.append((now + self.delay_s, data))
        ready = b"".join(data for at, data in self.waiting if at <= now)
        self.waiting = [(at, data) for at, data in self.waiting if at > now]
        return ready + (self.rng.bytes(200) if self.noise else b"")

    def send(self, data: bytes) -> None:
        """Send what is not lost."""
        if not (self.cut or self.rng.random() < self.loss):
            self.line.send(data)

    def close(self) -> None:
        """Close the line."""
        self.line.close()


class Trial:
    """One vehicle, driven, with a stopwatch."""

    def __init__(self, address: str) -> None:
        self.address = address
        self.line = BadLine(open_transport(parse_address(address)))
        self.link = MavlinkLink(self.line)
        self.other = mavlink.MAVLink(None, 255, 190)
        self.texts: list[str] = []

    def report(self) -> VehicleReport:
        """Return the report, and keep its texts."""
        report = self.link.report()
        self.texts += [t.text for t in report.texts]
        return report

    def wait(self, seconds: float, done: Callable[[VehicleReport], bool] | None = None, command=None) -> float | None:
        """Return after how many seconds something was so, or None."""
        began = time.monotonic()
        while time.monotonic() - began < seconds:
            if command is not None:
                self.link.command(*command)
            if done is not None and done(self.report()):
                return time.monotonic() - began
            time.sleep(0.1)
        return None

    def ready(self) -> None:
        """Get under way."""
        self.line.cut, self.line.loss, self.line.delay_s, self.line.noise = False, 0.0, 0.0, False
        if self.wait(150.0, lambda r: r.has_position and r.heartbeat_age_s < 1.0) is None:
            raise SystemExit("the autopilot has no position")
        for _ in range(5):
            try:
                self.link.arm()
                break
            except LinkRefused as refusal:
                print(f"  not yet: {refusal}", file=sys.stderr)
                self.wait(3.0)
        self.wait(6.0, command=AHEAD)
        self.texts.clear()

    def station(self, message) -> None:
        """Speak as another station on the same line."""
        self.line.line.send(message.pack(self.other))

    def parameter(self, name: str, value: float) -> None:
        """Set a parameter while driving on."""
        self.station(mavlink.MAVLink_param_set_message(1, 1, name.encode(), value, 9))
        self.wait(1.0, command=AHEAD)


AHEAD = (SPEED_M_S, 0.0, DEPTH_M)


def _still(report: VehicleReport) -> bool:
    return report.velocity is not None and math.hypot(*report.velocity[:2]) < 0.1


def _said(trial: Trial, words: str) -> str:
    return next((t for t in trial.texts if words.lower() in t.lower()), "")


def _row(fault: str, seen: float | None, reacted: float | None, what: str) -> dict:
    print(f"{fault}: seen {seen}, reacted {reacted}, {what}", file=sys.stderr, flush=True)
    return {"fault": fault, "seen_s": seen, "reacted_s": reacted, "what": what}


def _refused_arming(trial: Trial) -> dict:
    trial.link.disarm()
    trial.parameter("BATT_ARM_VOLT", 99.0)
    began, words = time.monotonic(), "armed all the same"
    try:
        trial.link.arm()
    except LinkRefused as refusal:
        words = f"`{refusal}`"
    took = time.monotonic() - began
    trial.parameter("BATT_ARM_VOLT", 0.0)
    return _row("arming refused (battery below BATT_ARM_VOLT)", took, None, words)


def _no_number(trial: Trial) -> dict:
    took = trial.wait(8.0, _still, (math.nan, math.nan, math.nan))
    return _row("a command of NaN", None, took, "zero speed was sent, the vehicle stood, still armed")


def _commands_stop(trial: Trial) -> dict:
    took = trial.wait(8.0, _still)
    return _row("commands stop, heartbeats go on", None, took, "GUIDED stood by its own time-out of 3 s, still armed")


def _pilots_mode(trial: Trial) -> dict:
    trial.station(mavlink.MAVLink_command_long_message(1, 1, 176, 0, 1, 16, 0, 0, 0, 0, 0))
    seen = trial.wait(5.0, lambda r: r.manual_override, AHEAD)
    stood = trial.wait(8.0, _still, AHEAD)
    return _row(
        "another station chooses POSHOLD", seen, (seen or 0) + (stood or 99), "taken over: our commands stopped"
    )


def _pilots_stick(trial: Trial) -> dict:
    began = time.monotonic()
    seen = None
    while seen is None and time.monotonic() - began < 5.0:
        trial.station(mavlink.MAVLink_manual_control_message(1, 0, 0, 500, 400, 0))
        trial.wait(0.08, command=AHEAD)
        if trial.report().manual_override:
            seen = time.monotonic() - began
    stood = trial.wait(8.0, _still, AHEAD)
    return _row(
        "a joystick moves at another station",
        seen,
        (seen or 0) + (stood or 99),
        "taken over: POSHOLD, where the stick steers",
    )


def _link_lost(trial: Trial) -> dict:
    trial.line.cut = True
    began = time.monotonic()
    seen = trial.wait(5.0, lambda r: r.heartbeat_age_s > 1.5 or time.monotonic() - r.pose_stamp_s > 0.5, AHEAD)
    trial.wait(9.0 - (time.monotonic() - began), command=AHEAD)
    trial.line.cut = False
    trial.wait(5.0, lambda r: r.heartbeat_age_s < 1.0)
    report = trial.report()
    what = f"when it was back: {'still armed' if report.armed else 'disarmed by the autopilot (FS_GCS_ENABLE 2)'}"
    return _row("link lost for 9 s (both ways)", seen, None, what)


def _stale(trial: Trial) -> dict:
    trial.wait(6.0, command=AHEAD)
    trial.line.delay_s = 1.0
    began = time.monotonic()
    seen = trial.wait(5.0, lambda r: time.monotonic() - r.pose_stamp_s > 0.5 and time.monotonic() - began > 1.3, AHEAD)
    age = time.monotonic() - trial.report().pose_stamp_s
    return _row("packets come 1 s late", seen, None, f"stamps say so: the pose was {age:.1f} s old")


def _lossy(trial: Trial) -> dict:
    trial.line.loss = 0.3
    trial.wait(10.0, command=AHEAD)
    report = trial.report()
    what = f"drove on at {report.velocity[0]:.2f} m/s, pose {time.monotonic() - report.pose_stamp_s:.2f} s old"
    return _row("30 % of the packets lost, for 10 s", None, None, what)


def _noisy(trial: Trial) -> dict:
    trial.line.noise = True
    trial.wait(10.0, command=AHEAD)
    report = trial.report()
    what = f"drove on at {report.velocity[0]:.2f} m/s, {report.reboots} restarts seen"
    return _row("random bytes between the packets, for 10 s", None, None, what)


def _leak(trial: Trial) -> dict:
    trial.parameter("FS_LEAK_ENABLE", 2.0)
    water = 0x20000000
    trial.station(mavlink.MAVLink_sys_status_message(water, water, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0))
    began = time.monotonic()
    seen = trial.wait(5.0, lambda r: r.leak, AHEAD)
    trial.wait(5.0, lambda r: r.mode == "SURFACE", AHEAD)
    mode_s = time.monotonic() - began
    up = trial.wait(30.0, lambda r: r.depth_m is not None and r.depth_m < 0.3, AHEAD)
    what = f"SURFACE after {mode_s:.1f} s, up from {DEPTH_M:g} m after {time.monotonic() - began:.0f} s; taken over"
    trial.parameter("FS_LEAK_ENABLE", 1.0)
    return _row("leak, FS_LEAK_ENABLE 2", seen, mode_s, what if up is not None else "did not come up")


def _battery(trial: Trial) -> dict:
    for name, value in (("BATT_LOW_VOLT", 12.0), ("BATT_LOW_TIMER", 2.0), ("BATT_FS_LOW_ACT", 3.0)):
        trial.parameter(name, value)
    trial.station(mavlink.MAVLink_param_set_message(1, 1, b"SIM_BATT_VOLTAGE", 10.5, 9))
    began = time.monotonic()
    seen = trial.wait(8.0, lambda r: r.battery_v is not None and r.battery_v < 11.5, AHEAD)
    trial.wait(10.0, lambda r: r.mode == "SURFACE", AHEAD)
    mode_s = time.monotonic() - began
    words = _said(trial, "is low")
    for name, value in (("SIM_BATT_VOLTAGE", 12.6), ("BATT_LOW_VOLT", 0.0), ("BATT_FS_LOW_ACT", 0.0)):
        trial.parameter(name, value)
    return _row("battery low (timer 2 s), BATT_FS_LOW_ACT 3", seen, mode_s, f"SURFACE; it said `{words}`")


def _position_lost(trial: Trial) -> dict:
    trial.station(mavlink.MAVLink_param_set_message(1, 1, b"SIM_GPS1_ENABLE", 0.0, 9))
    seen = trial.wait(20.0, lambda r: not r.has_position, AHEAD)
    report = trial.report()
    speed = math.hypot(*report.velocity[:2])
    trial.parameter("SIM_GPS1_ENABLE", 1.0)
    what = f"the pose's stamp stood still; it stayed in {report.mode} at {speed:.2f} m/s: the pilot has to stop it"
    return _row("position sensor silent", seen, None, what)


def _restart(trial: Trial) -> dict:
    trial.link.disarm()
    trial.station(mavlink.MAVLink_command_long_message(1, 1, 246, 0, 1, 0, 0, 0, 0, 0, 0))
    began = time.monotonic()
    seen = trial.wait(60.0, lambda r: r.reboots > 0)
    back = trial.wait(150.0, lambda r: r.has_position)
    what = f"streams asked for again; a position after {time.monotonic() - began:.0f} s"
    return _row(
        "autopilot restarts (disarmed)",
        seen,
        None,
        what if back else "no position",
    )


def _killed(trial: Trial) -> dict:
    """Another process drives, and is killed. The watching line sends no heartbeats."""
    second = trial.address.replace(":5760", ":5762")  # ArduSub in the loop takes one station on each port
    trial.link.close()
    child = subprocess.Popen([sys.executable, __file__, "--drive", trial.address], stdout=subprocess.PIPE, text=True)
    assert child.stdout is not None
    child.stdout.readline()
    watcher = MavlinkLink(BadLine(open_transport(parse_address(second))))
    watcher._keep_alive = _quiet(watcher)  # type: ignore[method-assign]
    began = time.monotonic()
    while time.monotonic() - began < 10.0:
        time.sleep(0.1)  # let it get under way
    os.kill(child.pid, signal.SIGKILL)
    child.wait()
    killed_at, stood, disarmed = time.monotonic(), None, None
    while time.monotonic() - killed_at < 9.0:
        report = watcher.report()
        if stood is None and _still(report):
            stood = time.monotonic() - killed_at
        if disarmed is None and not report.armed:
            disarmed = time.monotonic() - killed_at
        time.sleep(0.05)
    watcher.close()
    trial.__init__(trial.address)  # type: ignore[misc]
    when = "never" if disarmed is None else f"{disarmed:.1f} s"
    return _row("our program is killed (kill -9)", None, stood, f"stood; disarmed by FS_GCS_ENABLE 2 after {when}")


def _quiet(link: MavlinkLink) -> Callable[[float], None]:
    """Return a stand-in for the link's sending: it asks for streams as another system, and sends no heartbeats."""
    asker = mavlink.MAVLink(None, 42, 191)
    asked = [-math.inf]

    def ask(now: float) -> None:
        if now - asked[0] > 2.0:
            asked[0] = now
            for number in (30, 32, 193, 65, 74, 1):
                message = mavlink.MAVLink_command_long_message(1, 1, 511, 0, number, 1e5, 0, 0, 0, 0, 0)
                link._line.send(message.pack(asker))

    return ask


def _drive(address: str) -> None:
    """Be the program that is killed."""
    link = MavlinkLink(parse_address(address))
    while not (link.report().has_position and link.telemetry.kind):
        time.sleep(0.2)
    link.arm()
    print("under way", flush=True)
    while True:
        link.command(*AHEAD)
        time.sleep(0.1)


TRIALS = [
    _refused_arming, _no_number, _commands_stop, _pilots_mode, _pilots_stick, _link_lost, _stale, _lossy, _noisy,
    _leak, _battery, _position_lost, _killed, _restart,
]  # fmt: skip


def main() -> None:
    """Run the trials and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--vehicle", default="simulated")
    parser.add_argument("--only", default="", help="names of trials, separated by commas")
    parser.add_argument("--json", type=Path, help="write the rows into this file")
    parser.add_argument("--drive", help=argparse.SUPPRESS)
    flags = parser.parse_args()
    if flags.drive:
        _drive(flags.drive)
    address, server = flags.vehicle, None
    if address == "simulated":
        server = AutopilotServer(SimulatedAutopilot(Body(OpenWater()), AutopilotCfg(position_after_s=4.0)))
        address = server.address
    trial, rows = Trial(address), []
    for fault in TRIALS:
        if not flags.only or fault.__name__.strip("_") in flags.only.split(","):
            trial.ready()
            rows.append(fault(trial))
            if flags.json:
                flags.json.write_text(json.dumps(rows, indent=1))
    trial.link.close()
    if server is not None:
        server.close()
    print("| fault | seen after | vehicle reacted after | what happened |\n|---|---:|---:|---|")
    for found in rows:
        seen, reacted = ("" if s is None else f"{s:.1f} s" for s in (found["seen_s"], found["reacted_s"]))
        print(f"| {found['fault']} | {seen} | {reacted} | {found['what']} |")


if __name__ == "__main__":
    main()
