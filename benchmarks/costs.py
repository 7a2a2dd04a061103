"""Time of a cost program on one batch of rollouts, and of a change of belief.

Usage: python benchmarks/costs.py [--samples K] [--horizon H] [--json]

The program has two phases, contacts, orientations and a dozen terms, as much as the example in the appendix of the
CoRAL paper (A.6). It is evaluated over K x H states of push-pick-board in this process, in the confined one, and, for
some of the states, one by one, as it is written; all must agree exactly. Medians of CPU time; of the confined process,
where the work is another's, the least wall time.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from functools import partial

import numpy as np

from coral.contact.control.planning_world import ControlSequences, PlanningCfg, PlanningWorld
from coral.contact.cost.context import Context
from coral.contact.cost_program import CostProgram
from coral.contact.cost_program.worker import CostWorker
from coral.contact.scene.task_names import shipped_tasks
from coral.contact.scene.trial import sample_trial, stated_beliefs
from coral.contact.tasks import load_task
from coral.contact.worlds.hand_world import HandWorld

PROGRAM = """
def state_cost(self):
    def squash(x):
        return 1.0 / (1.0 + np.exp(-x))
    unit = lambda v: max(0.0, min(1.0, float(v)))
    weights = {"press": 11.0, "grip": 19.0, "align": 25.0, "lift": 30.0}
    cost = 0.0
    pos, speed, spin = np.array(self.board_pos), self.board_vel, self.board_angvel
    forward = np.array([1.0, 0.2, 0.0])
    forward = forward / (np.linalg.norm(forward) + 1e-9)
    handle = np.array(self.board_handle_pos)
    beyond = np.dot(handle - np.array([self.table_max[0], pos[1], pos[2]]), forward)
    done = unit(beyond / 0.05)
    calm = unit(np.exp(-2.5 * (np.linalg.norm(speed) + 0.4 * np.linalg.norm(spin))))
    s = squash(10.0 * (0.6 * done + 0.4 * calm - 0.5))
    cost += weights["press"] * (1.0 - s) * np.linalg.norm(self.ee_pos - (pos - 0.1 * forward))  # press
    cost += weights["grip"] * s * np.linalg.norm(self.ee_pos - handle)  # grip
    cost -= 15.0 * (1.0 - s) * done  # progress
    cost += 20.0 * (1.0 - s) * (0.0 if self.board_hand_contact else 1.0)  # touch
    turn = quat_angle(self.ee_quat, self.board_init_quat)
    cost += weights["align"] * s * min(turn, math.pi - turn) ** 2  # align
    moved = pos - np.array(self.board_init_pos)
    cost += 9.0 * (1.0 - s) * np.linalg.norm(moved - np.dot(moved, forward) * forward)  # drift
    cost += 7.0 * (1.0 - s) * quat_angle(self.board_quat, self.board_init_quat)  # rotation
    if self.board_left_contact and self.board_right_contact:
        cost += weights["lift"] * s * abs(pos[2] - 0.15)  # lift
    else:
        cost += 5.0 * s  # unheld
    for force in self.ee_force:
        cost += 0.01 * abs(force)
    cost += 0.001 * np.dot(self.last_action, self.last_action) + 0.002 * self.time
    return cost
"""


def timed(call: Callable[[], object], repeats: int) -> float:
    """Median of CPU time in ms."""
    call()
    found = []
    for _ in range(repeats):
        begun = time.process_time()
        call()
        found.append(1e3 * (time.process_time() - begun))
    return float(np.median(found))


def waited(call: Callable[[], object], repeats: int) -> float:
    """Least wall time in ms: what it takes when nobody else is in the way."""
    call()
    found = []
    for _ in range(repeats):
        begun = time.perf_counter()
        call()
        found.append(1e3 * (time.perf_counter() - begun))
    return min(found)


def rolled_out(samples: int, horizon: int) -> tuple[Context, PlanningWorld]:
    """States of a hand that wanders about the board."""
    trial = sample_trial(load_task("push-pick-board"), 0)
    now = HandWorld(trial).reset()
    world = PlanningWorld(trial, stated_beliefs(trial), now, PlanningCfg(threads=1))
    steps = np.random.default_rng(0).normal(scale=0.006, size=(samples, horizon, 3))
    way = now.objects["board"].position + np.array([0, 0, 0.02]) + np.cumsum(steps, axis=1)
    turns = np.tile(now.tool.quaternion, (samples, horizon, 1))
    context, _ = world.rollout(now, ControlSequences(way, turns, np.full((samples, horizon), 0.03), 600.0))
    return context, world


def single(state: Context, k: int, h: int) -> Context:
    """One state of a batch."""
    return Context(
        {
            name: state[name][k if state[name].shape[0] > 1 else 0, None][
                :, slice(h, h + 1) if state[name].shape[1] > 1 else slice(0, 1)
            ]
            for name in state.names()
        },
        (1, 1),
    )


def cost_rows(samples: int, horizon: int, repeats: int, alone: int) -> dict[str, object]:
    """Times of one batch, and whether the ways of evaluating it agree."""
    state, world = rolled_out(samples, horizon)
    program = CostProgram(PROGRAM, world.schema)
    with CostWorker() as worker:
        confined = worker.load(PROGRAM, world.schema)
        here, there = program(state), confined(state)
        same = all(np.array_equal(here[name], there[name]) for name in here)
        rng = np.random.default_rng(1)
        chosen = [(int(rng.integers(samples)), int(rng.integers(horizon))) for _ in range(alone)]
        exact = all(
            program(single(state, k, h))[name][0, 0] == np.broadcast_to(here[name], state.shape)[k, h]
            for k, h in chosen
            for name in here
        )
        batch = timed(lambda: program(state), repeats)
        each = timed(lambda: [program(single(state, k, h)) for k, h in chosen], 3) / alone * samples * horizon
        found = {
            "samples": samples,
            "horizon": horizon,
            "batch_ms": batch,
            "confined_ms": waited(lambda: confined(state), repeats),
            "one_by_one_ms": each,
            "ratio": each / batch,
            "confined_agrees": same,
            "one_by_one_agrees": exact,
        }
    world.close()
    return found


def belief_rows(repeats: int) -> list[dict[str, object]]:
    """Times of believing something else, for each shipped task."""
    rows: list[dict[str, object]] = []
    for task in shipped_tasks():
        trial = sample_trial(load_task(task), 0)
        world = PlanningWorld(trial, stated_beliefs(trial), HandWorld(trial).reset(), PlanningCfg(threads=1))
        rows.append({"task": task, "believe_ms": timed(partial(world.believe, stated_beliefs(trial)), repeats)})
        world.close()
    return rows


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--samples", type=int, default=200, help="K")
    parser.add_argument("--horizon", type=int, default=50, help="H")
    parser.add_argument("--repeats", type=int, default=15)
    parser.add_argument("--alone", type=int, default=100, help="states that are evaluated one by one")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    args = parser.parse_args()
    cost = cost_rows(args.samples, args.horizon, args.repeats, args.alone)
    beliefs = belief_rows(args.repeats)
    if args.json:
        print(json.dumps({"cost": cost, "beliefs": beliefs}))
        return
    print(f"| a cost, {args.samples} x {args.horizon} states | ms |\n|---|---:|")
    print(f"| in this process | {cost['batch_ms']:.1f} |\n| in the confined process | {cost['confined_ms']:.1f} |")
    print(f"| state by state | {cost['one_by_one_ms']:.0f} |\n")
    print(
        f"Agree exactly: confined {cost['confined_agrees']}, state by state {cost['one_by_one_agrees']}. "
        f"State by state takes {cost['ratio']:.0f} times as long.\n"
    )
    print("| another belief, planning model built anew | ms |\n|---|---:|")
    for row in beliefs:
        print(f"| {row['task']} | {row['believe_ms']:.1f} |")


if __name__ == "__main__":
    main()
