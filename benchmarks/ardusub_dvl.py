"""A double of a DVL for ArduSub in the loop: sends what the DVL's extension of BlueOS would send of the true motion.

Usage: python benchmarks/ardusub_dvl.py --line mavlink:tcp:127.0.0.1:5762 [--rate-hz 8] [--seed 0]

ArduSub's simulated GPS wanders by a metre; under water there is none. With the parameters that `--parameters` prints
the estimator takes its horizontal position from VISION_POSITION_DELTA instead, as on a BlueROV2 with a DVL A50.
The true velocity comes from SIM_STATE; the double adds a constant error of its scale, white noise of each velocity,
and a turn of its mounting. The error of the position then grows with the way, as a DVL's does.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from typing import Any

import numpy as np

from coral.contact.scene.geometry import rotation_vector
from coral.reef.sea import ardusub
from coral.reef.sea.address import parse_address
from coral.reef.sea.transport import open_transport
from coral.reef.vehicle.dynamics_kernels import rotation

PARAMETERS = {
    "VISO_TYPE": 1,
    "EK3_SRC1_POSXY": 6,
    "EK3_SRC1_VELXY": 6,
    "EK3_SRC1_POSZ": 1,
    "EK3_SRC1_VELZ": 0,
    "EK3_GPS_TYPE": 3,
    "GPS1_TYPE": 0,
    "SIM_GPS1_ENABLE": 0,
}
"""As the DVL's extension sets them, and no GPS."""
SIM_STATE, SET_MESSAGE_INTERVAL = 108, 511


class DvlDouble:
    """Listens to the truth, and sends increments of position and attitude.

    Args:
        line: Address of the autopilot.
        seed: Of scale, mounting and noise.
        scale, noise_m_s, mounting_rad: Standard deviations: the A50's data sheet says 0.1 to 1 % and some mm/s.
    """

    def __init__(self, line: str, seed: int, scale: float, noise_m_s: float, mounting_rad: float) -> None:
        self._dialect = ardusub.load_dialect()
        self._line = open_transport(parse_address(line))
        self._codec = self._dialect.MAVLink(None, 253, 197)
        self._codec.robust_parsing = True
        self._rng = np.random.default_rng(seed)
        self._scale = 1.0 + scale * self._rng.standard_normal()
        self._mounting = mounting_rad * self._rng.standard_normal()
        self._noise = noise_m_s
        self._way = np.zeros(3)
        self._last: Any = None
        self._sent: tuple[float, Any] | None = None
        self._origin_s = -math.inf

    def run(self, period_s: float) -> None:
        """Go on until the line ends."""
        asked = -math.inf
        while True:
            now = time.monotonic()
            data = self._line.receive(0.02)
            if now - asked > 2.0 and (self._last is None or now - self._last[0] > 1.0):
                asked = now
                self._send(self._dialect.MAVLink_command_long_message(
                    1, 1, SET_MESSAGE_INTERVAL, 0, float(SIM_STATE), 20_000.0, 0, 0, 0, 0, 0))  # fmt: skip
            if now - self._origin_s > 5.0:
                self._origin_s = now
                self._send(self._dialect.MAVLink_set_gps_global_origin_message(1, 430_000_000, -700_000_000, 0))
                self._send(self._dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
            for message in self._codec.parse_buffer(data) or [] if data else []:
                if message.get_type() == "SIM_STATE":
                    self._take(message, time.monotonic(), period_s)

    def _take(self, state: Any, now: float, period_s: float) -> None:
        if self._last is not None:
            self._way += (now - self._last[0]) * np.array([state.vn, state.ve, state.vd])
        self._last = (now, state)
        if self._sent is None:
            self._sent = (now, state)
        elif now - self._sent[0] >= period_s:
            self._report(now - self._sent[0], self._sent[1], state)
            self._sent = (now, state)
            self._way[:] = 0.0

    def _report(self, seconds: float, before: Any, after: Any) -> None:
        """Send the way since the last report, in the body frame of its beginning."""
        turn = rotation(before.roll, before.pitch, before.yaw)
        way = self._scale * (turn.T @ self._way) + self._noise * seconds * self._rng.standard_normal(3)
        c, s = math.cos(self._mounting), math.sin(self._mounting)
        way = np.array([c * way[0] - s * way[1], s * way[0] + c * way[1], way[2]])
        turned = rotation_vector(turn.T @ rotation(after.roll, after.pitch, after.yaw))
        self._send(self._dialect.MAVLink_vision_position_delta_message(
            int(1e6 * time.monotonic()), int(1e6 * seconds), turned.tolist(), way.tolist(), 95.0))  # fmt: skip

    def _send(self, message: Any) -> None:
        self._line.send(message.pack(self._codec))
        self._codec.seq = (self._codec.seq + 1) % 256


def main() -> None:
    """Parse, run."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--line", default="mavlink:tcp:127.0.0.1:5762", help="a line of the autopilot of its own")
    parser.add_argument("--parameters", action="store_true", help="print the parameters as a file for --defaults")
    parser.add_argument("--rate-hz", type=float, default=8.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--scale", type=float, default=0.005)
    parser.add_argument("--noise", type=float, default=0.005, help="m/s")
    parser.add_argument("--mounting-deg", type=float, default=0.5)
    args = parser.parse_args()
    if args.parameters:
        print("\n".join(f"{name} {value}" for name, value in PARAMETERS.items()))
        return
    double = DvlDouble(args.line, args.seed, args.scale, args.noise, math.radians(args.mounting_deg))
    try:
        double.run(1.0 / args.rate_hz)
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)


if __name__ == "__main__":
    main()
