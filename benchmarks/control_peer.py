"""Time of one control step beside pytorch-mppi doing the same work: same dynamics, costs, schedule, rollouts and steps.

Usage: python benchmarks/control_peer.py [--peer-python /path/to/venv/bin/python] [--steps 60] [--threads 1] [--json]

The peer needs torch and pytorch-mppi, in this environment or in another one whose interpreter is named. First both
score the same control sequences, and the largest difference of cost is printed. Then both plan, by turns, from the same
states of a drive through a field of discs. Ours is timed twice: as shipped, with its guided and dynamic-window samples,
and with samples about the previous plan, as the peer's are. Medians of CPU time (with several threads, of wall time).
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO

import numpy as np
from control import CASES, CELL_M, field_of_discs
from numpy.typing import NDArray

from coral.reef.drive.controller import DdpMppi, MppiCfg
from coral.reef.map.costfield import CostField
from coral.reef.vehicle.vehicle import VehicleCfg, VehicleDynamics, VehicleState

GOAL, START = (11.0, 11.0), VehicleState(1.5, 1.5, 0.5)
PEER = Path(__file__).parent / "peers" / "pytorch_mppi_step.py"
INSTALL = "pip install 'torch' 'pytorch-mppi==0.9.1' in any environment, and name it with --peer-python"
WARM_UP = 5
MEASURED = ("400 x 10 DDP (default)", "400 x 60 uniform, 6 s", "2000 x 56 uniform, 2.8 s")


@dataclass(frozen=True)
class World:
    """What both plan in."""

    distance: NDArray[np.float32]
    field: CostField

    @classmethod
    def make(cls) -> World:
        """The field of discs of control.py."""
        distance = field_of_discs()
        return cls(distance, CostField.compute(distance, GOAL, start=START[:2]))

    def plan(self, controller: DdpMppi, state: VehicleState):
        """One step of ours."""
        return controller.plan(state, self.field, self.distance, cell_m=CELL_M)


def drive(world: World, cfg: MppiCfg, steps: int) -> list[VehicleState]:
    """States of a drive by our own controller."""
    controller, vehicle = DdpMppi(cfg, rng=np.random.default_rng(0)), VehicleDynamics(VehicleCfg(), START)
    states = []
    for _ in range(steps):
        states.append(VehicleState(*map(float, vehicle.state[:6])))
        vehicle.step(world.plan(controller, vehicle.state).command)
        if math.dist(vehicle.state[:2], GOAL) < 1.0:
            vehicle.reset(START)
            controller.reset()
    return states


def write_problem(world: World, controller: DdpMppi, path: Path) -> None:
    """Everything the peer needs, as numbers."""
    cfg = controller.cfg
    start = np.array(START, dtype=np.float64)
    scene = controller._scene(start, world.field, world.distance, CELL_M)
    np.savez(path, **scene._asdict(), **controller._model._asdict(), weights=controller._weights,
             n_rollouts=cfg.n_rollouts, sigma_v=cfg.sigma_v, sigma_omega=cfg.sigma_omega, temperature=cfg.temperature,
             **controller.schedule._asdict())  # fmt: skip


class Peer:
    """The peer's process: requests and replies as JSON lines."""

    def __init__(self, process: subprocess.Popen[str], complaints: IO[str]) -> None:
        self._process, self._complaints = process, complaints
        self.about = self._read()

    def ask(self, **request):
        """One request, its reply."""
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(request) + "\n")
        self._process.stdin.flush()
        return self._read()

    def _read(self):
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            self._complaints.seek(0)
            raise SystemExit(f"the peer stopped:\n{self._complaints.read()}")
        return json.loads(line)


@contextmanager
def peer_at(python: str, problem: Path, threads: int) -> Iterator[Peer]:
    """A running peer."""
    command = [python, str(PEER), str(problem), str(threads)]
    # What it says on standard error is shown if it stops: torch complains at length about a NumPy newer than its own.
    with (
        tempfile.TemporaryFile("w+") as complaints,
        subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=complaints, text=True
        ) as process,
    ):
        try:
            yield Peer(process, complaints)
        finally:
            assert process.stdin is not None
            process.stdin.close()


def peer_is_there(python: str) -> bool:
    """Whether an interpreter has torch and pytorch-mppi."""
    try:
        done = subprocess.run([python, "-c", "import torch, pytorch_mppi"], capture_output=True, check=False)
    except OSError:
        return False
    return done.returncode == 0


def same_work(world: World, controller: DdpMppi, states: Sequence[VehicleState], peer: Peer) -> dict[str, float]:
    """Both score the same sequences at a few states: largest difference of cost, share of verdicts that agree."""
    worst, agreed, count = 0.0, 0, 0
    for state in states[:: max(1, len(states) // 4)]:
        start = np.array(state, dtype=np.float64)
        scene = controller._scene(start, world.field, world.distance, CELL_M)
        controls = controller._sample(start).copy()
        controls[:, :, 0] = controls[:, :, 0].clip(0.0, scene.speed_m_s)
        sent = controls.tolist()
        ours = controller._evaluate(start, controls, controller._free, scene)
        if scene.margin_m != controller.cfg.margin_m:
            continue  # very close to an obstacle ours relaxes its margin; the peer's problem does not change
        theirs = peer.ask(controls=sent, state=list(state), previous=controller._executed.tolist())
        free, free_there = np.isfinite(ours), ~np.array(theirs["hit"])
        both = free & free_there
        agreed, count = agreed + int((free == free_there).sum()), count + len(free)
        if both.any():
            worst = max(worst, float(np.abs(ours - np.array(theirs["costs"]))[both].max()))
    return {"compared": count, "cost_difference": worst, "verdicts_agree": agreed / count if count else math.nan}


def clock_for(threads: int) -> Callable[[], float]:
    """CPU time where one thread does the work: it leaves out what else the machine does."""
    return time.process_time if threads == 1 else time.perf_counter


def measure(name: str, cfg: MppiCfg, steps: int, python: str | None, threads: int) -> dict[str, object]:
    """One line of the table."""
    world = World.make()
    states = drive(world, cfg, steps + WARM_UP)
    ours = {
        "shipped": DdpMppi(cfg, rng=np.random.default_rng(0)),
        "same": DdpMppi(replace(cfg, warm_fraction=0.9, guided_fraction=0.0), rng=np.random.default_rng(0)),
    }
    times: dict[str, list[float]] = {"shipped": [], "same": [], "peer": []}

    clock = clock_for(threads)

    def by_turns(peer: Peer | None) -> None:
        for state in states:
            for key, controller in ours.items():
                begun = clock()
                world.plan(controller, state)
                times[key].append(1e3 * (clock() - begun))
            if peer is not None:
                times["peer"].append(peer.ask(state=list(state))["ms"])

    row: dict[str, object] = {"case": name, "rollouts": cfg.n_rollouts, "steps": cfg.n_steps}
    if python is None:
        by_turns(None)
    else:
        with tempfile.TemporaryDirectory() as folder:
            problem = Path(folder) / "problem.npz"
            write_problem(world, ours["same"], problem)
            with peer_at(python, problem, threads) as peer:
                checked = DdpMppi(cfg, rng=np.random.default_rng(1))
                row |= {
                    "torch": peer.about["torch"],
                    "threads": peer.about["threads"],
                    **same_work(world, checked, states, peer),
                }
                by_turns(peer)
    row |= {f"{key}_ms": float(np.median(values[WARM_UP:])) for key, values in times.items() if values}
    if "peer_ms" in row:
        row |= {"ratio_shipped": row["peer_ms"] / row["shipped_ms"], "ratio_same": row["peer_ms"] / row["same_ms"]}
    return row


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=60, help="timed steps in each case")
    parser.add_argument("--peer-python", default=sys.executable, help="interpreter that has torch and pytorch-mppi")
    parser.add_argument("--threads", type=int, default=1, help="of torch; ours uses one")
    parser.add_argument("--rollouts", type=int, default=0, help="instead of each case's own, for a quick look")
    parser.add_argument("--json", action="store_true")
    args = parser.parse_args()
    python = args.peer_python if peer_is_there(args.peer_python) else None
    if python is None:
        print(f"pytorch-mppi is not there, so these are our own figures only: {INSTALL}", file=sys.stderr)
    cases = {name: replace(CASES[name], n_rollouts=args.rollouts or CASES[name].n_rollouts) for name in MEASURED}
    rows = [measure(name, cfg, args.steps, python, args.threads) for name, cfg in cases.items()]
    if args.json:
        print(json.dumps(rows))
        return
    print("| control step | ours ms | ours, peer's sampling ms | pytorch-mppi ms | ratio | ratio, same sampling |")
    print("|---|---:|---:|---:|---:|---:|")
    for row in rows:
        peer = (
            f"{row['peer_ms']:.1f} | {row['ratio_shipped']:.0f}x | {row['ratio_same']:.0f}x"
            if python
            else "not there | | "
        )
        print(f"| {row['case']} | {row['shipped_ms']:.2f} | {row['same_ms']:.2f} | {peer} |")
    if python:
        worst, agree = max(r["cost_difference"] for r in rows), min(r["verdicts_agree"] for r in rows)
        compared = sum(r["compared"] for r in rows)
        print(
            f"\nThe same work: over {compared} sequences costs differ by at most {worst:.1e}, and verdicts on "
            f"collision agree in {100 * agree:.2f} %."
        )
        print(f"torch {rows[0]['torch']}, {rows[0]['threads']} thread(s), float32.")


if __name__ == "__main__":
    main()
