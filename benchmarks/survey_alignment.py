"""Alignment of a resumed survey on reefs on which its limits were not tuned: right, wrong, refused.

Usage: python benchmarks/survey_alignment.py [--reefs 10] [--first 9101] [--dives 4] [--json]

On each generated reef a survey of 80 s is saved. Then dives of 12 s begin on its track, half of them against its
direction, where the operator states a start that is off by up to 3 m and 30 degrees. A proposal that puts the vehicle
further than 0.5 m or 5 degrees from where it is, is wrong. For each dive on the right map there is one on the map of
the next reef, and one that is 5 to 8 m off, beyond the search: any proposal there is wrong. Pictures and poses are
exact.
"""

from __future__ import annotations

import argparse
import json
import math
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from coral.advisor.rules import RuleAdvisor
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.map.belief import Belief
from coral.reef.map.mapping import OccupancyMap
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.sea.known_ground import KnownGround
from coral.reef.sea.local_frame import LocalFrame, turned_about
from coral.reef.sea.map_alignment import MapAlignment, align_maps
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.world.generate import GeneratorCfg, generate
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import ReefWorld

SAVED_S, DIVE_TICKS, EVERY = 80.0, 120, 20
NEAR_M, NEAR_DEG = 0.5, 5.0


@dataclass(frozen=True)
class Saved:
    """A reef, what a survey of it knew, and its track."""

    world: ReefWorld
    ground: KnownGround
    track: np.ndarray
    """Shape=(N, 2) m."""


def ground_of(belief: Belief) -> KnownGround:
    """Return what a map shows; no fence."""
    return KnownGround.of_map(belief.map, np.zeros(belief.map.target.shape, bool))


def survey(seed: int) -> Saved:
    """Generate a reef and survey it for a while."""
    world = generate(GeneratorCfg(seed=seed, size_m=(26.0, 26.0), clusters=14), f"held-out-{seed}")
    with tempfile.TemporaryDirectory() as folder:
        record = RecordCfg(pictures=False, frames=False, report=False)
        cfg = MissionCfg(time_limit_s=SAVED_S, stop_when_covered=False, record=record)
        mission = Mission(world, cfg, RuleAdvisor(REEF_RULES), Path(folder) / "run", seed=0)
        mission.run()
        belief = mission.belief
        return Saved(world, ground_of(belief), np.array(belief.trajectory, float)[:, :2])


def dive(world: ReefWorld, poses: list[Pose], stated: LocalFrame) -> Iterator[Belief]:
    """Yield the map of a dive as it grows, in the frame that the operator stated."""
    camera = Camera(Scene.from_world(world), CameraCfg())
    belief = Belief(OccupancyMap(world.size_m, CameraCfg()))
    for pose in poses:
        belief.update(camera.render(pose), stated.inverse().to_survey(pose))
        yield belief


def attempt(
    rng: np.random.Generator, here: Saved, ground: KnownGround, off_m: float, back: bool
) -> tuple[MapAlignment | None, Pose, Pose]:
    """Dive along a survey's track; return the first proposal, where the vehicle is, and where it was stated to be."""
    k = int(rng.integers(0, len(here.track) - DIVE_TICKS))
    track = here.track[k : k + DIVE_TICKS]
    track = track[::-1] if back else track
    heading = np.arctan2(*np.gradient(track, axis=0)[:, ::-1].T)
    poses = [Pose(x, y, t) for (x, y), t in zip(track.tolist(), heading.tolist(), strict=True)]
    way, turn = rng.uniform(-math.pi, math.pi), math.radians(rng.uniform(-30.0, 30.0))
    true = poses[0]
    stated = Pose(true.x - off_m * math.cos(way), true.y - off_m * math.sin(way), true.theta - turn)
    frame = turned_about(stated, off_m * math.cos(way), off_m * math.sin(way), turn)
    for count, belief in enumerate(dive(here.world, poses, frame), 1):
        if count % EVERY == 0:
            found = align_maps(ground, ground_of(belief), stated)
            if not found.refusal:
                return found, true, stated
    return None, true, stated


def outcome(found: MapAlignment | None, true: Pose, stated: Pose) -> tuple[str, float, float]:
    """Judge a proposal: right, wrong or refused, and its errors (m, degrees)."""
    if found is None:
        return "refused", math.nan, math.nan
    place = found.shift.to_survey(stated)
    turned = math.degrees(math.remainder(place.theta - true.theta, 2 * math.pi))
    error = math.dist(place[:2], true[:2])
    return ("right" if error <= NEAR_M and abs(turned) <= NEAR_DEG else "wrong"), error, abs(turned)


def main() -> None:
    """Survey, dive, count."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--reefs", type=int, default=10)
    parser.add_argument("--first", type=int, default=9101, help="seed of the first reef")
    parser.add_argument("--dives", type=int, default=4, help="dives on each reef, of each kind")
    parser.add_argument("--json", action="store_true")
    args = parser.parse_args()
    saved = [survey(args.first + k) for k in range(args.reefs)]
    counts: dict[str, Counter[str]] = {}
    errors: list[tuple[float, float]] = []
    for k, here in enumerate(saved):
        rng = np.random.default_rng(args.first + k)
        for n in range(args.dives):
            back = bool(n % 2)
            for kind, ground, off_m in (
                ("against the track" if back else "along the track", here.ground, 3.0 * math.sqrt(rng.uniform())),
                ("map of another reef", saved[(k + 1) % len(saved)].ground, 3.0 * math.sqrt(rng.uniform())),
                ("5 to 8 m off", here.ground, rng.uniform(5.0, 8.0)),
            ):
                what, metres, degrees = outcome(*attempt(rng, here, ground, off_m, back))
                if kind in ("map of another reef", "5 to 8 m off") and what == "right":
                    what = "wrong"
                counts.setdefault(kind, Counter())[what] += 1
                if what == "right":
                    errors.append((metres, degrees))
        print(f"{here.world.name}: { ({kind: dict(found) for kind, found in counts.items()}) }", flush=True)
    worst = [max(each) for each in zip(*errors, strict=True)] if errors else []
    if args.json:
        print(json.dumps({"counts": counts, "worst": worst}))
        return
    print("| dive | right | wrong | refused |\n|---|---:|---:|---:|")
    for kind, found in counts.items():
        print(f"| {kind} | {found['right']} | {found['wrong']} | {found['refused']} |")
    if worst:
        print(f"\nLargest errors of the right ones: {worst[0]:.2f} m, {worst[1]:.1f} degrees.")


if __name__ == "__main__":
    main()
