"""Faults during a survey through MAVLink: what `coral reef sail` did, and after how many seconds. A Markdown table.

Usage: python benchmarks/sail_faults.py --vehicle mavlink:tcp:HOST:PORT --truth ADDRESS --station ADDRESS [--only WORDS]

Vehicle, truth and station are three lines to one simulation: ArduSub in the loop has a port for each, the simulated
autopilot (`python tests/autopilot s1`) takes all on one. Each row is a survey of its own in
real time; the fault begins under way. *Held*: seconds until the state changed; *stood*: until the true speed was below
0.1 m/s.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import os
import resource
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path

from coral.commands.reef_sail import ReefSail
from coral.errors import InputError, RunError
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.rehearsal.truth import TruthFeed
from coral.reef.sea.address import parse_address
from coral.reef.sea.ardusub import load_dialect
from coral.reef.sea.safety import SafetyCfg
from coral.reef.sea.transport import open_transport

AT_S, LASTS_S, LIMIT_S = 8.0, 3.0, 18.0
FORCED = 20190226.0
"""With this number ArduPilot restarts even while it is armed."""
mavlink = load_dialect()


class Proxy:
    """A TCP line between program and autopilot that can be cut."""

    def __init__(self, host: str, port: int) -> None:
        self.cut, self.target = False, (host, port)
        self.server = socket.create_server(("127.0.0.1", 0))
        self.address = f"mavlink:tcp:127.0.0.1:{self.server.getsockname()[1]}"
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self) -> None:
        while True:
            near, _ = self.server.accept()
            try:
                far = socket.create_connection(self.target)
            except OSError:  # an autopilot that restarts
                near.close()
                continue
            for source, sink in ((near, far), (far, near)):
                threading.Thread(target=self._pump, args=(source, sink), daemon=True).start()

    def _pump(self, source: socket.socket, sink: socket.socket) -> None:
        try:
            while data := source.recv(4096):
                if not self.cut:
                    sink.sendall(data)
        except OSError:
            pass
        for end in (source, sink):
            end.close()


class Bench:
    """One simulation, many surveys."""

    def __init__(self, vehicle: str, truth: str, station: str) -> None:
        self.truth = truth
        place = parse_address(vehicle)
        self.proxy = Proxy(place.host, place.port)
        self.line = open_transport(parse_address(station))
        self.other = mavlink.MAVLink(None, 255, 190)
        threading.Thread(target=self._drain, daemon=True).start()

    def _drain(self) -> None:
        while True:
            self.line.receive(0.2)

    def say(self, message) -> None:
        """Speak as another station."""
        self.line.send(message.pack(self.other))

    def parameter(self, name: str, value: float) -> None:
        """Set a parameter."""
        for _ in range(3):
            self.say(mavlink.MAVLink_param_set_message(1, 1, name.encode(), value, 9))
            time.sleep(0.3)

    def command(self, number: int, *values: float) -> None:
        """Give an order as another station."""
        self.say(mavlink.MAVLink_command_long_message(1, 1, number, 0, *[*values, *[0.0] * 7][:7]))

    def survey(self, name: str, act: Callable[[Path], None] | None, fault: str = "", **safety) -> dict:
        """Run a survey with a fault, and read what happened."""
        folder = Path(tempfile.mkdtemp()) / "run"
        sail = ReefSail(
            area="s1", vehicle=self.proxy.address, truth=self.truth, yes=True, quiet=True, out=folder,
            fault=(f"{fault}@{AT_S:g}:{LASTS_S:g}",) if fault else (),
            safety=SafetyCfg(**{"on_time": "none", "battery_min": 0.0, **safety}),
            cfg=MissionCfg(time_limit_s=LIMIT_S),
        )  # fmt: skip
        end: dict = {}

        def run() -> None:
            try:
                end.update(sail())
            except (InputError, RunError) as error:
                end["error"] = str(error)

        mouth, ear = os.pipe()[::-1]
        sys.stdin = os.fdopen(ear)  # the operator's keyboard
        thread = threading.Thread(target=run)
        thread.start()
        began = AT_S
        if act is not None:
            while thread.is_alive() and _last_t(folder) < AT_S:
                time.sleep(0.02)
            began = _last_t(folder)
            if thread.is_alive():
                act(folder)
        thread.join(25.0)
        if thread.is_alive():  # taken over: it waits for a person
            os.write(mouth, b"q\n")
            thread.join(60.0)
        os.close(mouth)
        return _read(name, folder, began, end)


def _last_t(folder: Path) -> float:
    try:
        return float((folder / "trajectory.csv").read_text().splitlines()[-1].split(",")[1])
    except (OSError, IndexError, ValueError):
        return -1.0


def _read(name: str, folder: Path, began: float, end: dict) -> dict:
    events = [json.loads(line) for line in (folder / "events.jsonl").open()] if folder.exists() else []
    states = [e for e in events if e["event"] == "state" and e["t"] >= began - 0.05]
    rows = list(csv.DictReader((folder / "trajectory.csv").open())) if folder.exists() else []
    held = states[0]["t"] - began if states else None
    moving = [r for r in rows if float(r["t"]) >= began]
    stood = next((float(r["t"]) - began for r in moving if math.hypot(float(r["u"]), float(r["v"])) < 0.1), None)
    what = f"{states[0]['state']}: {states[0]['reason']}" if states else end.get("error", "")
    if end.get("recording_failure"):
        what = f"drove on; recording stopped: {end['recording_failure']}"
    return {"fault": name, "held_s": held, "stood_s": stood, "collisions": end.get("collisions"), "what": what}


def _leak(bench: Bench) -> None:
    water = 0x20000000
    bench.say(mavlink.MAVLink_sys_status_message(water, water, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0))


def _fill(folder: Path) -> None:
    """Let every write that makes a file longer fail for a while, as on a full disk."""
    whole = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, ((folder / "trajectory.csv").stat().st_size, whole[1]))
    threading.Timer(LASTS_S, lambda: resource.setrlimit(resource.RLIMIT_FSIZE, whole)).start()


def _restart(bench: Bench) -> None:
    bench.command(mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1, 0, 0, 0, 0, FORCED)


def _cut(bench: Bench) -> None:
    bench.proxy.cut = True
    threading.Timer(LASTS_S, lambda: setattr(bench.proxy, "cut", False)).start()


def _killed(bench: Bench) -> dict:
    """Kill the program itself, and watch the vehicle."""
    folder = Path(tempfile.mkdtemp()) / "run"
    words = ["reef", "sail", "s1", "--vehicle", bench.proxy.address, "--truth", bench.truth, "--yes", "--quiet"]
    words += ["--safety.on-time", "none", "--safety.battery-min", "0", "--out", str(folder)]
    program = subprocess.Popen([sys.executable, "-m", "coral.cli", *words], stdout=subprocess.DEVNULL)
    while program.poll() is None and _last_t(folder) < AT_S:
        time.sleep(0.05)
    program.send_signal(signal.SIGKILL)
    program.wait()
    killed, stood, driven = time.monotonic(), None, 0.0
    feed = TruthFeed(parse_address(bench.truth)).run()
    before = None
    while time.monotonic() - killed < 10.0:
        time.sleep(0.25)
        state = feed.state
        if state is not None and before is not None and state.stamp_s > before.stamp_s:
            way = math.dist(state.pose[:2], before.pose[:2])
            driven += way
            if stood is None and way / (state.stamp_s - before.stamp_s) < 0.1:
                stood = time.monotonic() - killed
        before = state
    feed.close()
    what = f"drove on for {driven:.1f} m by the last set-point, then stood by the autopilot's own time-out"
    return {"fault": "program killed (kill -9)", "held_s": None, "stood_s": stood, "collisions": None, "what": what}


def _rows(bench: Bench, only: str) -> list[dict]:
    def battery(volts: float) -> None:
        bench.parameter("SIM_BATT_VOLTAGE", volts)

    def refused() -> dict:
        bench.parameter("BATT_ARM_VOLT", 99.0)
        row = bench.survey("arming refused", None)
        bench.parameter("BATT_ARM_VOLT", 0.0)
        return row

    def low() -> dict:
        row = bench.survey("battery low", lambda _: battery(10.5), battery_min_v=11.5, on_battery="surface")
        battery(12.6)
        return row

    trials: dict[str, Callable[[], dict]] = {
        "arming": refused,
        **{fault: (lambda fault=fault: bench.survey(fault, None, fault)) for fault in
           ("nan-pose", "stale-pose", "blind-camera", "wrong-size")},
        "link": lambda: bench.survey("link lost for 3 s", lambda _: _cut(bench)),
        "leak": lambda: bench.survey("leak", lambda _: _leak(bench)),
        "battery": low,
        "pilot": lambda: bench.survey("pilot chooses POSHOLD", lambda _: bench.command(176, 1.0, 16.0)),
        "disk": lambda: bench.survey("full disk", _fill),
        "killed": lambda: _killed(bench),
        "reboot": lambda: bench.survey("autopilot restarts", lambda _: _restart(bench)),
    }  # fmt: skip
    found = []
    for name, trial in trials.items():
        if not only or name in only.split(","):
            found.append(trial())
            print(found[-1], file=sys.stderr, flush=True)
    return found


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    for flag in ("--vehicle", "--truth", "--station"):
        parser.add_argument(flag, required=True)
    parser.add_argument("--only", default="")
    flags = parser.parse_args()
    print("| fault | held | stood | what happened |\n|---|---:|---:|---|")
    for row in _rows(Bench(flags.vehicle, flags.truth, flags.station), flags.only):
        held, stood = (("" if row[k] is None else f"{row[k]:.1f}") for k in ("held_s", "stood_s"))
        print(f"| {row['fault']} | {held} | {stood} | {row['what']} |", flush=True)


if __name__ == "__main__":
    main()
