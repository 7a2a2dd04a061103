"""What the simulated autopilot's camera and sonar would send, from a process of its own.

`python tests/autopilot/camera.py s1 --preset bay --latency 0.2 --dropped 0.1 --sonar 4747` listens to the simulated
vehicle at its second line, paints the reef from where it truly is, and serves the pictures as MJPEG. Classes, depth and
pose of the truth stay in this process. At the end (Ctrl-C) it tells what the vehicle has truly seen and touched.
"""

from __future__ import annotations

import argparse
import json
import signal
import socket
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.reef.map.sonar_3d15 import Sonar3d15
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.presets import PRESETS, apply_preset
from coral.reef.rehearsal.simulated_sensors import simulated_camera, simulated_sonar
from coral.reef.rehearsal.truth import follow_truth
from coral.reef.sea.frames import LocalFrame
from coral.reef.sea.record import ReefTruth
from coral.reef.sea.sonar_packets import encode_packet
from coral.reef.sea.transport import parse_address
from coral.reef.simulation.simulator import SimulatorCfg
from coral.reef.simulation.stills import make_painter
from coral.reef.vehicle.sensing import Stamped
from coral.reef.world.find_world import find_world
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import ReefWorld

BOUNDARY = "frame"
JPEG_QUALITY = 80


class MjpegServer:
    """Serves the newest picture to whoever connects, late and with gaps as asked."""

    def __init__(self, port: int = 0, latency_s: float = 0.0, dropped: float = 0.0, seed: int = 0) -> None:
        """Open a port of this computer (0: any free one). `dropped` is the share of pictures that are never sent."""
        self._latency_s, self._dropped, self._rng = latency_s, dropped, np.random.default_rng(seed)
        self._new = threading.Condition()
        self.waiting: list[tuple[float, bytes]] = []
        self.latest: tuple[int, bytes] = 0, b""
        self._closed = False
        pictures = self._pictures

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                self.send_response(200)
                self.send_header("Content-Type", f"multipart/x-mixed-replace; boundary={BOUNDARY}")
                self.end_headers()
                with suppress(ConnectionError):
                    for jpeg in pictures():
                        head = f"--{BOUNDARY}\r\nContent-Type: image/jpeg\r\nContent-Length: {len(jpeg)}\r\n\r\n"
                        self.wfile.write(head.encode() + jpeg + b"\r\n")

            def log_message(self, format: str, *words: object) -> None:
                """Say nothing."""

        self._server = ThreadingHTTPServer(("127.0.0.1", port), Handler)
        self._server.daemon_threads = True
        self.address = f"http://127.0.0.1:{self._server.server_port}/camera.mjpg"
        threading.Thread(target=self._server.serve_forever, daemon=True).start()
        threading.Thread(target=self._release, daemon=True).start()

    def offer(self, rgb: NDArray[np.uint8]) -> None:
        """Compress a picture and send it after the latency, unless it is one that gets lost."""
        if self._rng.random() < self._dropped:
            return
        jpeg = cv2.imencode(".jpg", rgb[:, :, ::-1], [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])[1].tobytes()
        with self._new:
            self.waiting.append((time.monotonic() + self._latency_s, jpeg))
            self._new.notify_all()

    def _release(self) -> None:
        while not self._closed:
            with self._new:
                while not self.waiting and not self._closed:
                    self._new.wait()
                due = self.waiting[0][0] if self.waiting else 0.0
            time.sleep(max(0.0, due - time.monotonic()))
            with self._new:
                if self.waiting:
                    self.latest = self.latest[0] + 1, self.waiting.pop(0)[1]
                self._new.notify_all()

    def _pictures(self) -> Iterator[bytes]:
        seen = 0
        while True:
            with self._new:
                while self.latest[0] == seen and not self._closed:
                    self._new.wait()
                if self._closed:
                    return
                seen, jpeg = self.latest
            yield jpeg

    def close(self) -> None:
        """Stop and free the port."""
        with self._new:
            self._closed = True
            self._new.notify_all()
        self._server.shutdown()
        self._server.server_close()


@contextmanager
def repeating(work: Callable[[], None]) -> Iterator[None]:
    """Repeat something in a thread until the block ends."""
    done = threading.Event()

    def run() -> None:
        while not done.is_set():
            work()

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    yield
    done.set()
    thread.join(timeout=5.0)


class Judge:
    """What a vehicle has truly inspected and touched."""

    def __init__(self, world: ReefWorld, cfg: SimulatorCfg, folder: Path) -> None:
        """Begin; `folder` takes the record."""
        self._truth = ReefTruth(world, cfg, folder, self._happened)
        self._contacts, self._least_m, self._begun_s = 0, float("inf"), time.monotonic()

    def _happened(self, event: str, **fields: object) -> None:
        self._contacts += event == "collision"

    def follow(self, pose: Pose) -> None:
        """Count up to a pose."""
        t = time.monotonic() - self._begun_s
        self._truth.follow(int(10 * t), t, pose)
        self._least_m = min(self._least_m, self._truth.clearance_m(pose))

    def verdict(self) -> dict[str, Any]:
        """Return shares (0 to 1), contacts, and the least distance to an obstacle (m)."""
        inspected = [cluster["inspected"] for cluster in self._truth.verdict([])["clusters"]]
        return {
            "clusters_covered": self._truth.judge.coverage,
            "inspected": round(float(np.mean(inspected)), 4),
            "inspected_of_each": inspected,
            "contacts": self._contacts,
            "least_clearance_m": round(self._least_m, 3),
        }


def main() -> None:
    """Serve until interrupted."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("world")
    parser.add_argument("--vehicle", default="mavlink:tcp:127.0.0.1:5790", help="the simulated autopilot")
    parser.add_argument("--preset", default="clear", choices=list(PRESETS), help="water and visibility")
    parser.add_argument("--port", type=int, default=8090)
    parser.add_argument("--rate", type=float, default=10.0, help="pictures a second")
    parser.add_argument("--latency", type=float, default=0.0, help="of a picture (s)")
    parser.add_argument("--dropped", type=float, default=0.0, help="share of the pictures that get lost")
    parser.add_argument("--sonar", type=int, default=0, help="UDP port of this computer for the sonar's packets")
    said = parser.parse_args()
    cfg, world = apply_preset(said.preset, MissionCfg(), find_world(said.world))
    sim = cfg.simulator
    start = Pose(world.start.x, world.start.y, world.start.theta)
    truth = follow_truth(parse_address(said.vehicle))
    begun: list[LocalFrame] = []

    def where() -> tuple[float, Pose] | None:
        if truth.latest is None:
            return None
        stamp_s, pose = truth.latest
        if not begun:  # the vehicle stands at the world's start
            begun.append(LocalFrame.from_start(pose, start, trust_heading=False))
        return stamp_s, begun[0].to_survey(pose)

    judge, scene = Judge(world, sim, Path(tempfile.mkdtemp())), Scene.from_world(world)
    painter = make_painter(scene, sim.camera, sim.picture_water(), sim.painter, world.seed)
    camera = simulated_camera(scene, sim.camera, where, said.rate, painter=painter)
    server = MjpegServer(said.port, said.latency, said.dropped)

    def picture() -> None:
        shot = camera.read()
        if shot is not None and shot.frame is not None:
            server.offer(shot.frame.rgb)
            judge.follow(where()[1])

    surface_z = None if world.water_depth_m is None else world.seabed.z_m + world.water_depth_m
    pings = Sonar3d15(scene.resting, sim.sonar, np.random.default_rng(3), surface_z=surface_z)
    sonar, line = simulated_sonar(pings, where, sim.camera.altitude_m), socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def ping() -> None:
        heard = sonar.read()
        if heard is not None:
            line.sendto(encode_packet(Stamped(time.time(), heard.value)), ("127.0.0.1", said.sonar))

    signal.signal(signal.SIGTERM, signal.default_int_handler)
    print(f"pictures at {server.address}; Ctrl-C ends them", file=sys.stderr, flush=True)
    with repeating(picture), repeating(ping if said.sonar else lambda: time.sleep(1.0)), suppress(KeyboardInterrupt):
        threading.Event().wait()
    print(json.dumps(judge.verdict()), flush=True)
    server.close()
    truth.close()


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[1]))
    main()
