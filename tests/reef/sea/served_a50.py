"""A DVL A50 for tests: serves its lines over TCP, fed with the true pose of a simulated vehicle, and falls silent."""

import json
import math
import socket
import threading
import time
from collections import deque

import numpy as np

from coral.reef.world.geometry import wrap

MEAN_S = 0.5
"""The true velocity is the mean over so long: true positions come in steps of a centimetre."""
NOISE_M_S = 0.005


class ServedA50:
    """Ten velocities and five positions a second, with noise; `mode` is what it does.

    speaking: as it should. quiet: sends nothing more. lost: says that its velocities are not valid.
    """

    def __init__(self, where, clock=time.monotonic):
        """`where()` returns a time (s) and the true pose, or None."""
        self.where, self.clock, self.mode = where, clock, "speaking"
        self.rng = np.random.default_rng(5)
        self.track = deque(maxlen=100)
        self.server = socket.create_server(("127.0.0.1", 0))
        self.port = self.server.getsockname()[1]
        self.closing = threading.Event()
        self.thread = threading.Thread(target=self.work, daemon=True)
        self.thread.start()

    def velocity(self):
        """True velocity in the body frame: forward, left (m/s)."""
        (t0, first), (t1, last) = self.track[0], self.track[-1]
        if t1 - t0 < 0.1:
            return 0.0, 0.0
        dx, dy = (last.x - first.x) / (t1 - t0), (last.y - first.y) / (t1 - t0)
        c, s = math.cos(last.theta), math.sin(last.theta)
        return c * dx + s * dy, c * dy - s * dx

    def lines(self, tick):
        """The lines of one tick of 0.1 s. The frame is that of the first pose, its axes forward and right."""
        found = self.where()
        if found is None:
            return []
        if not self.track:
            self.origin = found[1]
        while self.track and found[0] - self.track[0][0] > MEAN_S:
            self.track.popleft()
        self.track.append(found)
        forward, left = np.array(self.velocity()) + self.rng.normal(0.0, NOISE_M_S, 2)
        now = 1e6 * self.clock()
        velocity = {"type": "velocity", "format": "json_v3.1", "velocity_valid": False, "status": 0}
        if self.mode != "lost":
            variance = NOISE_M_S**2
            velocity |= {
                "velocity_valid": True,
                "vx": forward,
                "vy": -left,
                "vz": 0.0,
                "fom": NOISE_M_S,
                "covariance": [[variance, 0, 0], [0, variance, 0], [0, 0, variance]],
                "altitude": 1.0,
                "time_of_validity": now - 50_000,
                "time_of_transmission": now,
            }
        x, y, theta = found[1]
        c, s = math.cos(self.origin.theta), math.sin(self.origin.theta)
        dx, dy = x - self.origin.x, y - self.origin.y
        position = {
            "type": "position_local",
            "format": "json_v3.1",
            "x": c * dx + s * dy,
            "y": s * dx - c * dy,
            "z": 0.0,
            "std": 0.01,
            "roll": 0.0,
            "pitch": 0.0,
            "yaw": -math.degrees(wrap(theta - self.origin.theta)),
            "status": 0,
            "ts": now / 1e6,
        }
        return [velocity] if tick % 2 else [velocity, position]

    def work(self):
        self.server.settimeout(0.2)
        client, tick = None, 0
        while not self.closing.wait(0.1):
            if client is None:
                try:
                    client, _ = self.server.accept()
                except TimeoutError:
                    continue
            found, tick = self.lines(tick), tick + 1
            if self.mode != "quiet":
                try:
                    client.sendall("".join(json.dumps(line) + "\r\n" for line in found).encode())
                except OSError:
                    client = None

    def close(self):
        self.closing.set()
        self.thread.join(2.0)
        self.server.close()
