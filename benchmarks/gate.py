"""The gate: no advisor may be worse with the check of its answers than without it.

    python benchmarks/gate.py --worlds s1,e2 --seeds 0 --presets clear,hard --out gate

Each advisor surveys each reef twice, with the default check and without (`--variant no-verification`). A row says how
much of the reef was inspected within the time, and when 90 % were. Nothing steps in for an advisor (`hold`). The
clairvoyant knows the true clusters: it is a control, no method. `corrected`, not among the default ones, answers each
question first wrongly and then with a place that the refusal names: half of its answers are refused, and no more.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from clairvoyant import STEP_M, clairvoyant

from coral.advisor.question import Advisor, Rejection
from coral.advisor.registry import make_advisor
from coral.advisor.rules import RuleAdvisor
from coral.reef.decide.answers import CentroidChoice, WaypointChoice, WaypointStep
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.decide.mistakes import REEF_MISTAKES
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.presets import apply_preset
from coral.reef.mission.record import RecordCfg
from coral.reef.mission.variants import apply_variant
from coral.reef.world.find_world import find_world
from coral.reef.world.world import ReefWorld
from coral.runs import provenance


class Corrected:
    """Names a dot that there is not, or stays where it is, and then one of the places that the refusal names."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng

    def centroid(self, facts: Mapping[str, Any], rejections: Sequence[Rejection]) -> CentroidChoice:
        """Answer a question about dots."""
        if not rejections:
            return CentroidChoice(selected_centroid_index=9999)
        dot, step = self._named(facts)
        return CentroidChoice(selected_centroid_index=dot, waypoint=step)

    def waypoint(self, facts: Mapping[str, Any], rejections: Sequence[Rejection]) -> WaypointChoice:
        """Answer a question about open water."""
        dot, step = self._named(facts) if rejections else (None, None)
        step = step or WaypointStep(forward_m=0, left_m=0)
        return WaypointChoice(forward_m=step.forward_m, left_m=step.left_m, dot=dot)

    def _named(self, facts: Mapping[str, Any]) -> tuple[int | None, WaypointStep | None]:
        named = [*facts["passing"]["dots"], *facts["passing"]["waypoints"]]
        one = named[int(self._rng.integers(len(named)))]
        return (one, None) if isinstance(one, int) else (None, WaypointStep(forward_m=one[0], left_m=one[1]))


class Random:
    """Draws a dot of the map, or a waypoint in whole metres, whatever the map says."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng

    def centroid(self, facts: Mapping[str, Any], rejections: Sequence[Rejection]) -> CentroidChoice:
        """Answer a question about dots."""
        dots = facts["centroids"]
        return CentroidChoice(selected_centroid_index=dots[int(self._rng.integers(len(dots)))]["index"])

    def waypoint(self, facts: Mapping[str, Any], rejections: Sequence[Rejection]) -> WaypointChoice:
        """Answer a question about open water."""
        forward, left = (int(v) for v in self._rng.integers(-STEP_M, STEP_M + 1, 2))
        return WaypointChoice(forward_m=forward, left_m=left)


class Constant:
    """Chooses the first dot, or drives straight ahead, whatever the map says."""

    def centroid(self, facts: Mapping[str, Any], rejections: Sequence[Rejection]) -> CentroidChoice:
        """Answer a question about dots."""
        return CentroidChoice(selected_centroid_index=min(c["index"] for c in facts["centroids"]))

    def waypoint(self, facts: Mapping[str, Any], rejections: Sequence[Rejection]) -> WaypointChoice:
        """Answer a question about open water."""
        return WaypointChoice(forward_m=5, left_m=0)


ADVISORS = ("clairvoyant", "heuristic", "random", "sloppy:0.3:heuristic", "sloppy:0.6:heuristic", "constant")
VARIANTS = {"with": "full", "without": "no-verification"}


def advisor_of(name: str, world: ReefWorld, seed: int) -> Advisor:
    """Make an advisor, or one of the controls."""
    rng = np.random.default_rng([seed, 7])
    if name == "clairvoyant":
        return clairvoyant(world)
    controls = {"corrected": Corrected(rng), "random": Random(rng), "constant": Constant()}
    if name in controls:
        one = controls[name]
        return RuleAdvisor({"reef-centroid": one.centroid, "reef-waypoint": one.waypoint}, name=name)
    return make_advisor(name, rules=REEF_RULES, rng=rng, mistakes=REEF_MISTAKES)


def mission(name: str, world: str, seed: int, preset: str, check: str, limit_s: float, folder: Path) -> dict[str, Any]:
    """Run one mission; return its row, from its folder if it has run already."""
    kept = folder / "row.json"
    if kept.is_file():
        return dict(json.loads(kept.read_text(encoding="utf-8")))
    reef = find_world(world)
    cfg = MissionCfg(time_limit_s=limit_s, stop_when_covered=False, latency="fixed:10")
    cfg = replace(cfg, record=RecordCfg(pictures=False, frames=False, report=False, video=False))
    cfg = replace(cfg, pilot=replace(cfg.pilot, fallback="hold"))
    cfg, reef = apply_preset(preset, cfg, reef)
    cfg = apply_variant(VARIANTS[check], cfg)
    found = Mission(reef, cfg, advisor_of(name, reef, seed), folder, seed=seed, preset=preset).run()
    row = {
        "advisor": name,
        "world": world,
        "seed": seed,
        "preset": preset,
        "check": check,
        **{key: found[key] for key in ("inspected", "time_to_90_s", "collisions", "advisor_calls", "answers")},
    }
    kept.write_text(json.dumps(row), encoding="utf-8")
    return row


def table(rows: Sequence[dict[str, Any]], limit_s: float) -> str:
    """Return a line for each advisor and preset."""
    lines = [
        "| preset | advisor | missions | inspected (%): with; without | to 90 % (s), limit where never: with; without "
        "| contacts | refused with | worse missions |",
        "|---|---|---:|---:|---:|---:|---:|---:|",
    ]
    for preset, name in dict.fromkeys((row["preset"], row["advisor"]) for row in rows):
        pairs: dict[Any, dict[str, Any]] = {}
        for row in rows:
            if (row["preset"], row["advisor"]) == (preset, name):
                pairs.setdefault((row["world"], row["seed"]), {})[row["check"]] = row
        both = [pair for pair in pairs.values() if len(pair) == 2]
        if not both:
            continue
        seen, soon, touched = (
            {check: [pair[check][key] for pair in both] for check in VARIANTS}
            for key in ("inspected", "time_to_90_s", "collisions")
        )
        late = {check: [limit_s if t is None else t for t in times] for check, times in soon.items()}
        worse = sum(
            w < wo - 0.02 or (abs(w - wo) <= 0.02 and t > u + 10.0)
            for w, wo, t, u in zip(seen["with"], seen["without"], late["with"], late["without"], strict=True)
        )
        answers = [pair["with"]["answers"] for pair in both]
        given = sum(sum(one.values()) for one in answers)
        lines.append(
            f"| {preset} | {name} | {len(both)} "
            f"| {100 * np.mean(seen['with']):.1f}; {100 * np.mean(seen['without']):.1f} "
            f"| {np.mean(late['with']):.0f}; {np.mean(late['without']):.0f} "
            f"| {sum(touched['with'])}; {sum(touched['without'])} "
            f"| {sum(one['refused'] for one in answers)}/{given} | {worse} |"
        )
    return "\n".join(lines)


def main() -> None:
    """Run the grid and print its table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--worlds", default="s1,k2,e2,o1")
    parser.add_argument("--seeds", default="0")
    parser.add_argument("--presets", default="clear,hard")
    parser.add_argument("--advisors", default=",".join(ADVISORS))
    parser.add_argument("--limit-s", type=float, default=600.0)
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args()
    rows = []
    for preset in args.presets.split(","):
        for world in args.worlds.split(","):
            for name in args.advisors.split(","):
                for seed in map(int, args.seeds.split(",")):
                    for check in VARIANTS:
                        folder = args.out / f"{preset}-{world}-{name.replace(':', '_')}-{seed}-{check}"
                        rows.append(mission(name, world, seed, preset, check, args.limit_s, folder))
                        print(json.dumps(rows[-1]), flush=True)
    print(table(rows, args.limit_s))
    print(f"Commit {provenance()['commit']}; {args}")


if __name__ == "__main__":
    main()
