"""What a drifting position does to a survey at sea, with and without the localizer.

`python benchmarks/sea_drift.py --seeds 3 4` drives `SeaMission` around simulated reefs on a fake clock. The reported
position moves away from the true one by a share of the way, in a direction that is drawn once; the heading is right.
"""

from __future__ import annotations

import argparse
import math
import statistics
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent / "tests" / "reef" / "sea"))

from voyage import Voyage

from coral.reef.map.localization import LocalizationCfg
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.world.geometry import Pose
from coral.reef.world.world import load_world
from coral.reef.world.world_names import shipped_worlds

TOLD = LocalizationCfg(drift_xy=0.03, drift_theta=0.002)
"""What the localizer is told of the drift, per square root of a second (m, rad)."""


class ShareOfTheWay:
    """Reports a position that is off by a share of the way so far."""

    def __init__(self, share: float, seed: int) -> None:
        """Draw the direction."""
        angle = np.random.default_rng(seed).uniform(-math.pi, math.pi)
        self._aside, self._way_m = (share * math.cos(angle), share * math.sin(angle)), 0.0
        self._last: Pose | None = None

    def step(self, true_pose: Pose, dt: float) -> Pose:
        """Return the reported pose."""
        if self._last is not None:
            self._way_m += math.dist(true_pose[:2], self._last[:2])
        self._last = true_pose
        x, y = (self._way_m * share for share in self._aside)
        return Pose(true_pose.x + x, true_pose.y + y, true_pose.theta)


def main() -> None:
    """Print a line for each survey, and medians."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--worlds", nargs="+", default=shipped_worlds())
    parser.add_argument("--seeds", nargs="+", type=int, default=[0], help="of the drift's direction")
    parser.add_argument("--share", type=float, default=0.01)
    parser.add_argument("--limit-s", type=float, default=600.0)
    said = parser.parse_args()
    for name, localization in (("with", TOLD), ("without", LocalizationCfg())):
        errors, inspected, contacts, clearance = [], [], 0, math.inf
        for reef, seed in ((reef, seed) for seed in said.seeds for reef in said.worlds):
            with tempfile.TemporaryDirectory() as folder:
                drift = ShareOfTheWay(said.share, seed)
                cfg = MissionCfg(localization=localization)
                found = Voyage(
                    Path(folder) / "run", time_limit_s=said.limit_s, cfg=cfg, drift=drift, world=load_world(reef)
                ).run()
            errors.append(found["position_error_m"])
            inspected.append(found["inspected"])
            contacts += found["collisions"]
            clearance = min(clearance, found["min_clearance_m"])
            print(
                f"{name} {reef} seed {seed}: {errors[-1]:.2f} m off (odometry {found['odometry_error_m']:.2f}) after "
                f"{found['distance_m']:.0f} m, {100 * inspected[-1]:.1f} % inspected, {found['collisions']} contacts",
                flush=True,
            )
        print(
            f"{name} the localizer, {len(errors)} surveys: median {statistics.median(errors):.2f} m, "
            f"{min(errors):.2f} to {max(errors):.2f} m; inspected {100 * min(inspected):.1f} to "
            f"{100 * max(inspected):.1f} %; {contacts} contacts, least clearance {clearance:.2f} m"
        )


if __name__ == "__main__":
    main()
