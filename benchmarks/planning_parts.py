"""What each part of the planning model costs: CPU time of 200 rollouts of 50 control steps, with one part changed.

Usage: python benchmarks/planning_parts.py [--tasks pick-box,pick-clutter] [--repeats 5] [--json]

The hand begins 5 cm over the first object, as far open as it goes, and walks about at random; every row sees the same
walks. One thread. Medians; the rows take turns, so that what else the machine does falls on all of them.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from coral.contact.control.planning_world import ControlSequences, PlanningCfg, PlanningWorld
from coral.contact.scene.prior_beliefs import stated_beliefs
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.worlds.hand_world import HandWorld, HandWorldCfg

STIFFNESS = 600.0


@dataclass(frozen=True)
class Part:
    """One part changed.

    Args:
        name: Of the row.
        change: Applied to every model.
        awake: Nothing sleeps.
        edges: The table is a box however far its edges are.
    """

    name: str
    change: Callable[[mujoco.MjModel], None] = lambda model: None
    awake: bool = False
    edges: bool = False


def disabled(flag: str) -> Callable[[mujoco.MjModel], None]:
    """With something switched off."""

    def change(model: mujoco.MjModel) -> None:
        model.opt.disableflags |= bit(flag)

    return change


def bit(flag: str) -> int:
    """Its bit; 0 in a MuJoCo that knows no such flag, where its row changes nothing."""
    return int(getattr(mujoco.mjtDisableBit, flag, 0))


def several_points(model: mujoco.MjModel) -> None:
    """Curved surfaces touch at as many points as MuJoCo finds."""
    model.opt.disableflags &= ~bit("mjDSBL_MULTICCD")


def few_iterations(model: mujoco.MjModel) -> None:
    """Of the solver of contacts."""
    model.opt.iterations = 3


def fingers_alone(model: mujoco.MjModel) -> None:
    """Palm and wrist touch nothing."""
    for name in ("palm", "wrist"):
        model.geom(name).contype = model.geom(name).conaffinity = 0


PARTS = (
    Part("as it is planned with"),
    Part("nothing sleeps", awake=True),
    Part("cylinders touch at several points", several_points),
    Part("both", several_points, awake=True),
    Part("without MuJoCo's islands, and so without sleep", disabled("mjDSBL_ISLAND"), awake=True),
    Part("table with edges", edges=True),
    Part("without sensors", disabled("mjDSBL_SENSOR")),
    Part("palm and wrist touch nothing", fingers_alone),
    Part("three iterations of the solver", few_iterations),
    Part("nothing touches anything", disabled("mjDSBL_CONTACT")),
)


def trial(task: str, part: Part, samples: int, horizon: int) -> Callable[[], object]:
    """Rollouts of a task with a part changed."""
    trial = sample_trial(load_task(task), 0)
    now = HandWorld(trial, HandWorldCfg()).reset()
    above = now.objects[trial.task.objects[0].name].position + np.array([0, 0, 0.05])
    now = replace(now, tool=replace(now.tool, position=above))
    walk = np.cumsum(np.random.default_rng(0).normal(scale=0.004, size=(samples, horizon, 3)), axis=1)
    controls = ControlSequences(
        above + walk, np.tile(now.tool.quaternion, (samples, horizon, 1)), np.full((samples, horizon), 0.08), STIFFNESS
    )
    cfg = PlanningCfg(threads=1)
    world = PlanningWorld(trial, stated_beliefs(trial), now, replace(cfg, rest_m_s=0.0) if part.awake else cfg)
    world.edges = part.edges
    world.rollout(now, controls)
    for model in (*world.models, *world._endless):
        part.change(model)
    return lambda: world.rollout(now, controls)


def measure(task: str, samples: int, horizon: int, repeats: int) -> dict[str, float]:
    """Median CPU time of each row, ms."""
    calls = {part.name: trial(task, part, samples, horizon) for part in PARTS}
    found: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(repeats):
        for name, call in calls.items():
            before = time.process_time()
            call()
            found[name].append(1e3 * (time.process_time() - before))
    return {name: float(np.median(times)) for name, times in found.items()}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tasks", default="pick-box,pick-clutter")
    parser.add_argument("--samples", type=int, default=200)
    parser.add_argument("--horizon", type=int, default=50)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--json", action="store_true")
    args = parser.parse_args()
    result = {task: measure(task, args.samples, args.horizon, args.repeats) for task in args.tasks.split(",")}
    if args.json:
        print(json.dumps(result))
        return
    print(f"| CPU ms of {args.samples} rollouts of {args.horizon} control steps | {' | '.join(result)} |")
    print("|---|" + "---:|" * len(result))
    for part in PARTS:
        print(f"| {part.name} | {' | '.join(f'{rows[part.name]:.0f}' for rows in result.values())} |")


if __name__ == "__main__":
    main()
