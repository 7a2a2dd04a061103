"""Time of rollouts in the planning world beside a plain Python loop and judo; time of a plan against K and H.

Usage: python benchmarks/planner.py [--peer-python /path/to/venv/bin/python] [--out docs/research] [--json]
       python benchmarks/planner.py --fewer 48 [--repeats 15]

All do the same work: K sequences of H control steps (two physics steps each) of the hand near the box of pick-box,
and all must end in the same place. Ours also looks for rollouts that diverged, and makes of the quantities that a
cost may use those that the cost of picking reads. judo pins an older MuJoCo, so it runs in an environment of its own,
where MuJoCo's rollout is timed alone too. Then a whole plan of each task on one thread and on two. Medians; CPU time is
summed over threads. With --out, the curves are written as contact-planner.csv and contact-planner.png. With --fewer
only whole plans of each task are timed, with --samples rollouts and with fewer in turn.
"""

from __future__ import annotations

import argparse
import csv
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from coral.contact.control.mppi_controller import Controller, ControllerCfg
from coral.contact.control.planning_model import reduced
from coral.contact.control.planning_world import ControlSequences, PlanningCfg, PlanningWorld
from coral.contact.cost.stages import Stage
from coral.contact.experts import expert
from coral.contact.scene.geometry import conjugate, rotate
from coral.contact.scene.observation import Observation
from coral.contact.scene.prior_beliefs import stated_beliefs
from coral.contact.scene.task_file import shipped_tasks
from coral.contact.scene.trial import Trial, sample_trial, with_beliefs
from coral.contact.tasks import load_task
from coral.contact.worlds.hand_world import HandWorld
from coral.mppi.knots import KnotMppiCfg

PEER = Path(__file__).parent / "peers" / "judo_rollout.py"
INSTALL = "pip install judo-rai in an environment of its own, and name it with --peer-python"
SAMPLES, HORIZONS = (25, 50, 100, 200, 400), (10, 25, 50, 75, 100)
STIFFNESS = 600.0
READ = (
    "box_pos",
    "box_quat",
    "box_left_contact",
    "box_right_contact",
    "box_size",
    "box_init_pos",
    "ee_pos",
    "ee_quat",
    "ee_vel",
    "gripper_target",
)
"""What the single-stage cost of picking reads."""


@dataclass(frozen=True)
class Problem:
    """What everyone rolls out."""

    trial: Trial
    now: Observation
    controls: ControlSequences

    @classmethod
    def make(cls, samples: int, horizon: int) -> Problem:
        """Random walks of the hand about the box of pick-box, from just above it."""
        trial = sample_trial(load_task("pick-box"), 0)
        now = HandWorld(trial).reset()
        above = now.objects["box"].position + np.array([0, 0, 0.03])
        now = replace(now, tool=replace(now.tool, position=above))
        walk = np.cumsum(np.random.default_rng(0).normal(scale=0.004, size=(samples, horizon, 3)), axis=1)
        turns = np.tile(now.tool.quaternion, (samples, horizon, 1))
        return cls(trial, now, ControlSequences(above + walk, turns, np.full((samples, horizon), 0.08), STIFFNESS))

    def world(self, threads: int) -> PlanningWorld:
        """Ours."""
        world = PlanningWorld(self.trial, stated_beliefs(self.trial), self.now, PlanningCfg(threads=threads))
        world.edges = True  # the same model for everyone, and the one that the peers are given
        return world


def timed(calls: Mapping[str, Callable[[], Any]], repeats: int) -> dict[str, dict[str, float]]:
    """Medians of wall and CPU time in ms of each; they take turns, so that what else runs here falls on all."""
    found: dict[str, list[tuple[float, float]]] = {name: [] for name in calls}
    for call in calls.values():
        call()
    for _ in range(repeats):
        for name, call in calls.items():
            wall, cpu = time.perf_counter(), time.process_time()
            call()
            found[name].append((time.perf_counter() - wall, time.process_time() - cpu))
    medians = {name: 1e3 * np.median(times, axis=0) for name, times in found.items()}
    return {name: {"wall_ms": float(wall), "cpu_ms": float(cpu)} for name, (wall, cpu) in medians.items()}


def plain_loop(world: PlanningWorld, problem: Problem) -> NDArray[np.float64]:
    """The same with mj_step in three nested loops; states, Shape=(K, H, nq + nv), after each control step."""
    model, controls = world.models[0], problem.controls
    data, initial = mujoco.MjData(model), world._initial(problem.now)
    samples, horizon = controls.opening.shape
    substeps = round(world.cfg.step_s / world.cfg.physics_dt_s)
    states = np.empty((samples, horizon, model.nq + model.nv))
    sensors = np.empty((samples, horizon, model.nsensordata))
    for k in range(samples):
        mujoco.mj_setState(model, data, initial, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        data.qacc_warmstart[:] = 0
        for h in range(horizon):
            data.ctrl[:2] = controls.opening[k, h] / 2
            data.mocap_pos[0], data.mocap_quat[0] = controls.position[k, h], controls.quaternion[k, h]
            for _ in range(substeps):
                mujoco.mj_step(model, data)
            states[k, h, : model.nq], states[k, h, model.nq :] = data.qpos, data.qvel
            sensors[k, h] = data.sensordata
    return states


def rolled_out(world: PlanningWorld, problem: Problem) -> list[NDArray[np.float64]]:
    """Ours, and what is read of it."""
    context, _ = world.rollout(replace(problem.now), problem.controls)  # a new measurement, as in every plan
    return [context[name] for name in READ]


def peer(problem: Problem, world: PlanningWorld, python: str, repeats: int) -> dict[str, Any] | None:
    """Figures of judo, or None where it is missing."""
    model, now, controls = world.models[0], problem.now, problem.controls
    substeps = round(world.cfg.step_s / world.cfg.physics_dt_s)
    ctrl = np.zeros((*controls.opening.shape, model.nu))
    ctrl[..., 0] = ctrl[..., 1] = controls.opening / 2
    # judo sends nothing but ctrl: the impedance's target stays, and its inputs displace it in its own axes.
    ctrl[..., 2:5] = rotate(conjugate(now.tool.quaternion), controls.position - now.tool.position)
    with tempfile.TemporaryDirectory() as folder:
        spec = reduced(
            with_beliefs(problem.trial, stated_beliefs(problem.trial)), world.cfg.hand, world.cfg.physics_dt_s
        )
        spec.compile()
        Path(folder, "model.xml").write_text(spec.to_xml(), encoding="utf-8")
        np.savez(Path(folder, "problem.npz"), ctrl=np.repeat(ctrl, substeps, axis=1), initial=world._initial(now),
                 gainprm=model.actuator_gainprm, biasprm=model.actuator_biasprm,
                 target=np.concatenate([now.tool.position, now.tool.quaternion]))  # fmt: skip
        command = [python, str(PEER), folder, str(repeats)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, check=True)
        except (OSError, subprocess.CalledProcessError):
            return None
        found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
        context, _ = world.rollout(now, controls)
        end = np.load(Path(folder, "end.npy"))[:, world._index.pose["box"]][:, :3]
        gap = np.linalg.norm(end - context.box_pos[:, -1], axis=1)
        found["box_gap_mm"] = {"median": 1e3 * float(np.median(gap)), "largest": 1e3 * float(gap.max())}
        return found


def compare(samples: int, horizon: int, python: str, repeats: int) -> dict[str, Any]:
    """Ours on one and two threads, the plain loop, judo."""
    problem = Problem.make(samples, horizon)
    one, two = problem.world(1), problem.world(2)
    context, sane = one.rollout(problem.now, problem.controls)
    qpos = one._index.pose["box"]
    assert sane.all()
    assert np.array_equal(plain_loop(one, problem)[..., qpos][..., :3], context.box_pos), "the loop ends elsewhere"
    rows = timed(
        {
            "ours, 1 thread": lambda: rolled_out(one, problem),
            "ours, 2 threads": lambda: rolled_out(two, problem),
            "plain Python loop": lambda: plain_loop(one, problem),
        },
        repeats,
    )
    found = peer(problem, one, python, repeats)
    if found is None:
        print(f"no judo here: {INSTALL}", file=sys.stderr)
    else:
        rows["judo"] = found["rows"]["judo"]
        for threads in (1, 2):
            rows[f"mujoco.rollout alone in judo's MuJoCo, {threads} threads"] = found["rows"][f"mujoco, {threads}"]
    return {
        "samples": samples,
        "horizon": horizon,
        "mujoco": mujoco.__version__,
        "rows": rows,
        "peer": found and {key: found[key] for key in ("versions", "box_gap_mm")},
    }


def plan(controller: Controller, now: Observation, stage: Stage) -> None:
    """One plan from what was just measured."""
    controller.plan(replace(now), stage, 0)


def curve_row(samples: int, horizon: int, repeats: int) -> dict[str, float]:
    """Time of one whole plan of picking, sampling and costs included, on one thread."""
    problem = Problem.make(1, 1)
    cfg = ControllerCfg(horizon=horizon, mppi=KnotMppiCfg(samples=samples))
    controller = Controller(problem.world(1), cfg, np.random.default_rng(0))
    stage = expert(problem.trial.task, "expert").stages[0]
    whole = timed({"plan": partial(plan, controller, problem.now, stage)}, repeats)["plan"]
    return {"samples": samples, "horizon": horizon, "plan_cpu_ms": whole["cpu_ms"], "plan_wall_ms": whole["wall_ms"]}


def task_row(task: str, samples: int, horizon: int, repeats: int) -> dict[str, Any]:
    """Time of a whole plan of a task, the hand just above its first object, on one thread and on two."""
    trial = sample_trial(load_task(task), 0)
    now = HandWorld(trial).reset()
    above = now.objects[trial.task.objects[0].name].position + np.array([0, 0, 0.05])
    now = replace(now, tool=replace(now.tool, position=above))
    stage = expert(trial.task, "expert").stages[0]
    cfg = ControllerCfg(horizon=horizon, mppi=KnotMppiCfg(samples=samples))
    worlds = [PlanningWorld(trial, stated_beliefs(trial), now, PlanningCfg(threads=threads)) for threads in (1, 2)]
    found = timed(
        {
            f"plan_ms_{threads}": partial(plan, Controller(world, cfg, np.random.default_rng(0)), now, stage)
            for threads, world in enumerate(worlds, 1)
        },
        repeats,
    )
    for world in worlds:
        world.close()
    return {"task": task} | {name: row["wall_ms"] for name, row in found.items()}


def fewer_row(task: str, samples: int, fewer: int, horizon: int, repeats: int) -> dict[str, Any]:
    """Time of a whole plan of a task with more rollouts and with fewer in turn: CPU, and wall on two threads."""
    trial = sample_trial(load_task(task), 0)
    now = HandWorld(trial).reset()
    above = now.objects[trial.task.objects[0].name].position + np.array([0, 0, 0.05])
    now = replace(now, tool=replace(now.tool, position=above))
    stage = expert(trial.task, "expert").stages[0]
    world = PlanningWorld(trial, stated_beliefs(trial), now, PlanningCfg(threads=2))
    cfgs = {k: ControllerCfg(horizon=horizon, mppi=KnotMppiCfg(samples=k)) for k in (samples, fewer)}
    found = timed(
        {
            str(k): partial(plan, Controller(world, cfg, np.random.default_rng(0)), now, stage)
            for k, cfg in cfgs.items()
        },
        repeats,
    )
    world.close()
    return {"task": task, "more": found[str(samples)], "fewer": found[str(fewer)]}


def draw_curves(curves: dict[str, list[dict[str, float]]], path: Path) -> None:
    """Two curves side by side."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure, panes = plt.subplots(1, 2, figsize=(8, 3), sharey=True, layout="constrained")
    for pane, (key, rows), title in zip(
        panes, curves.items(), ("rollouts K, H = 50", "control steps H, K = 200"), strict=True
    ):
        pane.plot([row[key] for row in rows], [row["plan_cpu_ms"] for row in rows], "o-", color="#2a6f97")
        pane.set_xlabel(title)
        pane.set_xlim(left=0)
        pane.grid(alpha=0.3)
    panes[0].set_ylim(bottom=0)
    panes[0].set_ylabel("CPU time of a plan, ms")
    figure.savefig(path, dpi=130)
    plt.close(figure)


def main() -> None:
    """Print the table; write the curves."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--peer-python", default=sys.executable, help="interpreter that has judo")
    parser.add_argument("--samples", type=int, default=200, help="K of the table")
    parser.add_argument(
        "--horizon", type=int, default=50, help="H of the table, and the largest K and H of the curves in proportion"
    )
    parser.add_argument("--repeats", type=int, default=15)
    parser.add_argument("--out", type=Path, help="folder for the curves, such as docs/research")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--fewer", type=int, help="only time whole plans, with this many rollouts and with --samples")
    args = parser.parse_args()
    if args.fewer:
        print(f"| a whole plan | CPU ms, K = {args.samples} | K = {args.fewer} | ratio | wall ms | wall ms | ratio |")
        print("|---|---:|---:|---:|---:|---:|---:|")
        for task in shipped_tasks():
            row = fewer_row(task, args.samples, args.fewer, args.horizon, args.repeats)
            cells = [task]
            for clock in ("cpu_ms", "wall_ms"):
                more, fewer = row["more"][clock], row["fewer"][clock]
                cells += [f"{more:.0f}", f"{fewer:.0f}", f"{fewer / more:.2f}"]
            print(f"| {' | '.join(cells)} |", flush=True)
        return
    result = compare(args.samples, args.horizon, args.peer_python, args.repeats)
    result["tasks"] = [task_row(task, args.samples, args.horizon, args.repeats) for task in shipped_tasks()]
    if args.out:
        result["curves"] = {
            "samples": [curve_row(k * args.samples // 200, args.horizon, args.repeats) for k in SAMPLES],
            "horizon": [curve_row(args.samples, max(2, h * args.horizon // 50), args.repeats) for h in HORIZONS],
        }
        args.out.mkdir(parents=True, exist_ok=True)
        with (args.out / "contact-planner.csv").open("w", newline="", encoding="utf-8") as stream:
            rows = [
                {"curve": name} | {key: round(value, 1) for key, value in row.items()}
                for name, lines in result["curves"].items()
                for row in lines
            ]
            writer = csv.DictWriter(stream, list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
        draw_curves(result["curves"], args.out / "contact-planner.png")
    if args.json:
        print(json.dumps(result))
        return
    print(f"| {args.samples} rollouts of {args.horizon} control steps | wall ms | CPU ms | ratio of CPU |")
    print("|---|---:|---:|---:|")
    ours = result["rows"]["ours, 1 thread"]["cpu_ms"]
    for name, row in result["rows"].items():
        print(f"| {name} | {row['wall_ms']:.0f} | {row['cpu_ms']:.0f} | {row['cpu_ms'] / ours:.2f} |")
    one, two = (result["rows"][f"ours, {name}"]["wall_ms"] for name in ("1 thread", "2 threads"))
    print(f"\nThe second thread makes ours {one / two:.2f} times as fast.")
    print("\n| a whole plan | 1 thread, wall ms | 2 threads, wall ms | ratio |")
    print("|---|---:|---:|---:|")
    for row in result["tasks"]:
        one, two = row["plan_ms_1"], row["plan_ms_2"]
        print(f"| {row['task']} | {one:.0f} | {two:.0f} | {one / two:.2f} |")
    print(f"\nRatios: to ours on one thread. MuJoCo {result['mujoco']}; the peer: {json.dumps(result['peer'])}")


if __name__ == "__main__":
    main()
