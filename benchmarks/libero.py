"""Success on LIBERO-OBJECT and on LIBERO-PRO's perturbed suites of it, in our worlds (`make setup-libero` first).

    python benchmarks/libero.py --states 0,5,10,15,20,25,30,35,40,45 --out libero

The expert's state machine on the Panda, poses tracked, the time of planning charged. A state is one of the benchmark's
50 initial states of a task, and the seed of masses, frictions and noise. All tasks of all suites come before the next
state, so that a run that is stopped early has them all. A line of JSON for each trial is appended to OUT/trials.jsonl;
a second call goes on where the first one stopped, and prints the tables.
"""

from __future__ import annotations

import argparse
import json
import shutil
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from statistics import fmean, median
from typing import Any

from coral.campaign.spec import parse_names, parse_seeds
from coral.campaign.stats import wilson
from coral.contact.control.planning_world import PlanningCfg
from coral.contact.episode.campaign_episode import run_episode
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.episode import Episode
from coral.contact.episode.referee import Referee
from coral.contact.episode.resolution import resolve_episode
from coral.contact.episode.variants import AdvisorSetup, make_strategist
from coral.contact.libero.package import SUITES
from coral.contact.scene.judge import Judge
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.think_cfg import resolved
from coral.contact.worlds.evaluation_world import TruthfulWorld

TASKS = 10
CONTROL_S = 20.0
"""Time of a control, twice that of most successes."""
KEPT = ("success", "end_reason", "sim_time_s", "peak_hand_force_n", "pose_error_mm", "track_lost", "wall_time_s")


def run_trial(suite: str, task: int, state: int, cfg: EpisodeCfg, world: str, out: Path) -> dict[str, Any]:
    """Run a trial and return its row."""
    cfg = replace(cfg, record=replace(cfg.record, report=False, video=False))
    found = load_task(f"libero:{suite}/{task}/{state}")
    folder = cleared(out / "runs" / found.name)
    row = run_episode(found, cfg, folder, world=world, variant="expert-fsm", advisor="none", seed=state)
    return {"suite": suite, "task": task, "state": state, **{key: row.get(key) for key in KEPT}}


def cleared(folder: Path) -> Path:
    """Return a trial's folder without what a stopped run left; a trial that ended has a row and never gets here."""
    shutil.rmtree(folder, ignore_errors=True)
    return folder


def run_control(suite: str, task: int, state: int, cfg: EpisodeCfg, world: str, out: Path) -> dict[str, Any]:
    """Run a trial whose robot is told another object of the scene, and return its row, judged by the right one.

    `own_goal` says whether the other object was in the basket at the end.
    """
    right = sample_trial(load_task(f"libero:{suite}/{task}/{state}"), state)
    (inside,) = right.task.success.conditions
    other = next(item.name for item in right.task.objects if item.name != inside.object)
    told = right.task.success.model_copy(update={"conditions": (inside.model_copy(update={"object": other}),)})
    objects = sorted(right.task.objects, key=lambda item: item.name != other)  # the expert moves the first one
    update = {"success": told, "time_limit_s": CONTROL_S, "objects": tuple(objects)}
    wrong = replace(right, task=right.task.model_copy(update=update))
    cfg = replace(cfg, record=replace(cfg.record, report=False, video=False))
    folder = cleared(out / "runs" / f"{suite}-{task}-{state}")
    think = resolved(cfg.think, cfg.controller, "none")
    setup = AdvisorSetup(advisor="none", seed=state, world=world, folder=folder, think=think)
    strategist = make_strategist("expert-fsm", wrong.task, setup)
    episode = Episode(wrong, world, strategist, cfg, folder, variant="expert-fsm")
    truthful = episode.world
    assert isinstance(truthful, TruthfulWorld)
    episode.referee = Referee("truth", Judge(right), truthful.truth)
    own = OwnGoal(Judge(wrong), truthful)
    row = episode.run([own])
    ids = {"suite": suite, "task": task, "state": state, "told": other, "own_goal": own.reached}
    return {**ids, **{key: row.get(key) for key in KEPT}}


class OwnGoal:
    """Notices that the robot's own goal was reached, and ends the trial a second later; an observer.

    Args:
        judge: Of that goal.
        world: The world.
    """

    def __init__(self, judge: Judge, world: TruthfulWorld) -> None:
        self._judge, self._world = judge, world
        self.reached, self._left = False, 25

    def tick(self, run: Episode) -> None:
        """See `Observer.tick`."""
        self.reached = self.reached or self._judge.success(self._world.truth())
        self._left -= self.reached

    def stop_requested(self) -> str:
        """See `Observer.stop_requested`."""
        return "its own goal reached" if self._left <= 0 else ""


def read_rows(path: Path) -> list[dict[str, Any]]:
    """Read the finished trials; a line cut short by a kill is left out."""
    rows = []
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else ():
        try:
            rows.append(json.loads(line))
        except json.JSONDecodeError:
            continue
    return rows


def run_missing(args: argparse.Namespace, run: Callable[[str, int, int], dict[str, Any]]) -> Sequence[dict[str, Any]]:
    """Run the trials that `args.out` does not have yet, and return all rows.

    Args:
        args: States, tasks, suites and the folder.
        run: Runs the trial of a suite, task and state, and returns its row.
    """
    args.out.mkdir(parents=True, exist_ok=True)
    path = args.out / "trials.jsonl"
    done = {(row["suite"], row["task"], row["state"]) for row in read_rows(path)}
    for state in parse_seeds(args.states, "--states"):
        for task in parse_seeds(args.tasks, "--tasks"):
            for suite in parse_names(args.suites, "--suites"):
                if (suite, task, state) in done:
                    continue
                row = run(suite, task, state)
                with path.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(row) + "\n")
                print(json.dumps(row), flush=True)
    return read_rows(path)


def print_tables(rows: Sequence[Mapping[str, Any]]) -> None:
    """Print success by suite, and by suite and task."""
    suites = list(dict.fromkeys(row["suite"] for row in rows))
    print("| suite | success | 95 % interval | mean time | median pose error | otherwise ended by |")
    print("|---|---:|---:|---:|---:|---|")
    for name in (*suites, "all"):
        own = [row for row in rows if name in (row["suite"], "all")]
        won = [row for row in own if row["success"]]
        low, high = wilson(len(won), len(own))
        ends = Counter(row["end_reason"] for row in own if not row["success"])
        times = [row["sim_time_s"] for row in won]
        errors = [row["pose_error_mm"] for row in own if row.get("pose_error_mm") is not None]
        print(
            f"| {name} | {len(won)} of {len(own)} | {100 * low:.0f} to {100 * high:.0f} % | "
            f"{f'{fmean(times):.1f} s' if times else '-'} | "
            f"{f'{median(errors):.1f} mm' if errors else '-'} | "
            f"{', '.join(f'{reason} {count}' for reason, count in ends.most_common()) or '-'} |"
        )
    print(f"\n| task | {' | '.join(suites)} |\n|---|{'---:|' * len(suites)}")
    for task in range(TASKS):
        print(f"| {task} | {' | '.join(_count(rows, suite, task) for suite in suites)} |")


def _count(rows: Iterable[Mapping[str, Any]], suite: str, task: int) -> str:
    own = [row["success"] for row in rows if (row["suite"], row["task"]) == (suite, task)]
    return f"{sum(own)} of {len(own)}" if own else "-"


def main() -> None:
    """Run the trials that are missing, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--suites", default=",".join(SUITES))
    parser.add_argument("--tasks", default="0-9")
    parser.add_argument("--states", default="0")
    parser.add_argument("--samples", type=int, default=40, help="rollouts per plan")
    parser.add_argument("--latency", default="fixed:0.04", help="as --cfg.planning.latency")
    parser.add_argument("--world", default="panda")
    parser.add_argument("--wrong-object", action="store_true", help="a control: tell the robot another object")
    parser.add_argument("--out", type=Path, default=Path("runs/libero"))
    args = parser.parse_args()
    cfg = resolve_episode(EpisodeCfg(planning=PlanningCfg(latency=args.latency, threads=1)), samples=args.samples)
    run = run_control if args.wrong_object else run_trial
    print_tables(run_missing(args, lambda suite, task, state: run(suite, task, state, cfg, args.world, args.out)))


if __name__ == "__main__":
    main()
