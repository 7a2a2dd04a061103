"""How far dead reckoning drifts along a survey: by Doppler log and IMU, and by the random walks of the presets.

Usage: python benchmarks/reef_navigation.py RUN [--seconds 600] [--dives 30]
RUN is the folder of a run; its true path is driven again and again, to and fro where it is shorter, with new errors.
"""

import argparse
import math
from pathlib import Path

import numpy as np

from coral.reef.simulation.noise import PoseDrift, SensorNoiseCfg
from coral.reef.simulation.simulated_navigation import NavigationCfg, SimulatedNavigation
from coral.reef.vehicle.sensing import Attitude
from coral.reef.world.geometry import Pose, wrap
from coral.runs import read_rows

LEVEL = Attitude(roll=0.0, pitch=0.0, depth_m=4.0, altitude_m=1.0)
DT = 0.1


def true_path(run, seconds):
    """Poses of a run, repeated backwards and forwards. Backwards the vehicle drives astern: no jump at the ends."""
    rows = np.array([[float(row[key]) for key in ("x", "y", "theta")] for row in read_rows(run / "trajectory.csv")])
    there_and_back = np.concatenate([rows, rows[-2:0:-1]])
    count = round(seconds / DT) + 1
    return np.tile(there_and_back, (count // len(there_and_back) + 1, 1))[:count]


def body_velocities(path):
    """Velocity in the body frame at each pose: forward, left (m/s), turn (rad/s), by central differences."""
    step = np.gradient(path[:, :2], DT, axis=0)
    c, s = np.cos(path[:, 2]), np.sin(path[:, 2])
    turn = np.gradient(np.unwrap(path[:, 2]), DT)
    return np.stack([c * step[:, 0] + s * step[:, 1], c * step[:, 1] - s * step[:, 0], turn], axis=1)


def error(pose, found):
    """x, y (m) and heading (rad) of an estimate, less the truth."""
    return found[0] - pose[0], found[1] - pose[1], wrap(found[2] - pose[2])


def by_sensors(path, seed, cfg):
    """Error at the end, and its covariance, of dead reckoning by Doppler log and IMU."""
    navigation = SimulatedNavigation(cfg, Pose(*path[0]), np.random.default_rng(seed))
    for k, (pose, velocity) in enumerate(zip(path.tolist(), body_velocities(path).tolist(), strict=True)):
        fix = navigation.step(Pose(*pose), tuple(velocity), LEVEL, DT if k else 0.0)
    return error(path[-1], fix.pose), fix.covariance


def by_walk(path, seed, xy):
    """Error at the end of a random walk of `xy` (m/√s) and a tenth of it in heading, as in the presets."""
    drift = PoseDrift(SensorNoiseCfg(drift_xy=xy, drift_theta=xy / 10), np.random.default_rng(seed))
    for k, pose in enumerate(path.tolist()):
        found = drift.step(Pose(*pose), DT if k else 0.0)
    return error(path[-1], found), None


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", type=Path)
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--dives", type=int, default=30)
    args = parser.parse_args()
    path = true_path(args.run, args.seconds)
    way = float(np.hypot(*np.diff(path[:, :2], axis=0).T).sum())
    print(f"{args.run}: {args.seconds:g} s, {way:.0f} m, {args.dives} dives; errors at the end\n")
    print("| dead reckoning | mean | largest | heading, mean | told (1 sigma) | squared error by covariance |")
    print("|---|---:|---:|---:|---:|---:|")
    kinds = {
        "DVL A50 and IMU": lambda seed: by_sensors(path, seed, NavigationCfg(source="dvl-imu")),
        "random walk of `bay`": lambda seed: by_walk(path, seed, 0.02),
        "random walk of `hard`": lambda seed: by_walk(path, seed, 0.06),
    }
    for name, dive in kinds.items():
        found = [dive(seed) for seed in range(args.dives)]
        errors = np.array([each for each, _ in found])
        away, turned = np.hypot(errors[:, 0], errors[:, 1]), np.abs(errors[:, 2])
        told = squared = ""
        if found[0][1] is not None:
            told = f"{np.mean([math.sqrt(p[0, 0] + p[1, 1]) for _, p in found]):.2f} m"
            squares = [e @ np.linalg.solve(p, e) for e, (_, p) in zip(errors, found, strict=True)]
            squared = f"{np.mean(squares):.1f} of 3"
        heading = f"{math.degrees(turned.mean()):.1f}°"
        print(f"| {name} | {away.mean():.2f} m | {away.max():.2f} m | {heading} | {told} | {squared} |", flush=True)


if __name__ == "__main__":
    main()
