"""How often a hand that moves at random solves a task: what an expert, a rule or a model must beat.

    python benchmarks/contact_random.py [--seeds 0-9] [--seconds 15] [--tasks all]

The hand's target goes to points drawn over the table, palm down, with an opening drawn anew at each. It sees nothing.
With --still it does not move at all.
"""

from __future__ import annotations

import argparse

import numpy as np

from coral.campaign.spec import parse_names, parse_seeds
from coral.contact.scene.judge import Judge
from coral.contact.scene.observation import HandTarget
from coral.contact.scene.task_file import shipped_tasks, unseen_tasks
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.worlds.hand_world import HandWorld, HandWorldCfg
from coral.contact.worlds.robot_world import WorldError

LOW, HIGH = np.array([-0.3, -0.3, 0.0]), np.array([0.3, 0.3, 0.25])
EVERY_STEPS, STEP_M = 25, 0.01
"""Control steps between two points, and the target's way in one step: 0.5 m/s."""
DOWN = np.array([0.0, 1.0, 0.0, 0.0])


def solves(name: str, seed: int, seconds: float, still: bool) -> bool:
    """Return whether a task is solved within so many seconds."""
    trial = sample_trial(load_task(name), seed)
    world, judge, rng = HandWorld(trial, HandWorldCfg()), Judge(trial), np.random.default_rng(seed)
    try:
        goal = target = world.reset().tool.position.copy()
        opening = 0.08
        for step in range(round(seconds / world.control_period_s)):
            if not still and step % EVERY_STEPS == 0:
                goal, opening = rng.uniform(LOW, HIGH), float(rng.uniform(0.0, 0.08))
            way = goal - target
            target = target + way * min(1.0, STEP_M / max(float(np.linalg.norm(way)), 1e-9))
            world.step(HandTarget(target, DOWN, opening, 600.0))
            truth = world.truth()
            if judge.success(truth):
                return True
            if judge.failure(truth) is not None:
                return False
    except WorldError:
        return False
    finally:
        world.close()
    return False


def main() -> None:
    """Print a row for each task that was solved, and the sum."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", default="0-9")
    parser.add_argument("--seconds", type=float, default=15.0)
    parser.add_argument("--tasks", default="all", help="separated by commas; all: the shipped and the unseen ones")
    parser.add_argument("--still", action="store_true")
    args = parser.parse_args()
    seeds, rows = parse_seeds(args.seeds), []
    every = (*shipped_tasks(), *unseen_tasks("development"), *unseen_tasks("test"))
    for name in every if args.tasks == "all" else parse_names(args.tasks, "--tasks"):
        count = sum(solves(name, seed, args.seconds, args.still) for seed in seeds)
        rows.append(count)
        if count:
            print(f"| {name} | {count} of {len(seeds)} |", flush=True)
    print(
        f"all {len(rows)} tasks: {sum(rows)} of {len(rows) * len(seeds)}; {sum(map(bool, rows))} of them at least once"
    )


if __name__ == "__main__":
    main()
