"""Lifelong learning: success and advisor calls over a stream of changing tasks, with and without a memory.

    python benchmarks/contact_lifelong.py --trials 60 --out lifelong

The stream takes turns between two families of tasks; each trial is one of the development cases of the memory's test
set (`coral memory bench`) or the shipped task itself, with a seed of its own. Both arms see the same stream with the
same seeds, in the hand world, with few samples, true poses and the time of planning charged (0.02 s). The advisor is
the rule system with plausible errors in half of its answers (`sloppy`), which is what a memory of successes can make up
for. The memory begins empty.

A line of JSON for each trial is appended to OUT/trials.jsonl; a second call goes on where the first one stopped. The
figure is OUT/lifelong.png.
"""

from __future__ import annotations

import argparse
import json
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import numpy as np

from coral.campaign.stats import sign_test
from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.control.planning_world import PlanningCfg
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.episode import Episode
from coral.contact.episode.retrieval_cases import NOTHING, load_retrieval_cases
from coral.contact.episode.variants import AdvisorSetup, make_strategist
from coral.contact.scene.task import Task
from coral.contact.scene.task_file import load_task_file
from coral.contact.scene.trial import sample_trial
from coral.contact.thinker.think_cfg import resolved
from coral.mppi.knots import KnotMppiCfg

FAMILIES = ("pick-box", "flip-box")
"""The cheapest families: their trials last 2 to 5 s of simulated time."""
FIRST_SEED = 1000
LIMIT_S = 8.0
ARMS = {"with memory": "full", "without": "no-memory"}


def stream(trials: int) -> list[Task]:
    """Return the tasks of the stream: families in turn, their versions in an order drawn once."""
    cases = load_retrieval_cases("development")
    rng = np.random.default_rng(0)
    versions = {
        family: [
            load_task_file(family),
            *(one.task for one in cases if one.origin == family and NOTHING not in one.fits),
        ]
        for family in FAMILIES
    }
    found = []
    for k in range(trials):
        held = versions[FAMILIES[k % len(FAMILIES)]]
        found.append(held[int(rng.integers(len(held)))].model_copy(update={"time_limit_s": LIMIT_S}))
    return found


def run_trial(task: Task, k: int, arm: str, advisor: str, samples: int, out: Path) -> dict[str, Any]:
    """Run one trial of the stream and return its row."""
    cfg = EpisodeCfg(
        poses="ground-truth",
        replan_steps=4,
        controller=ControllerCfg(mppi=KnotMppiCfg(samples=samples)),
        planning=PlanningCfg(threads=1, latency="fixed:0.02"),
    )
    cfg = replace(cfg, record=replace(cfg.record, report=False, video=False))
    folder = out / arm.replace(" ", "-") / f"{k:03d}"
    shutil.rmtree(folder, ignore_errors=True)  # what a stopped run left: a trial that ended has a row
    setup = AdvisorSetup(
        advisor=advisor,
        seed=FIRST_SEED + k,
        world="hand",
        folder=folder,
        think=resolved(cfg.think, cfg.controller, advisor),
        memory=out / "memory.sqlite" if arm == "with memory" else None,
    )
    episode = Episode(
        sample_trial(task, setup.seed),
        "hand",
        make_strategist(ARMS[arm], task, setup),
        cfg,
        folder,
        variant=ARMS[arm],
        advisor=advisor,
    )
    result = episode.run()
    keys = ("success", "advisor_calls", "repairs", "memory_hit", "sim_time_s", "end_reason")
    return {
        "trial": k,
        "arm": arm,
        "task": task.name,
        "instruction": task.instruction,
        **{key: result[key] for key in keys},
    }


def draw(rows: Sequence[dict[str, Any]], path: Path) -> None:
    """Draw the share of successes and the advisor's calls, both cumulative, over the trials."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2), constrained_layout=True)
    for arm, colour in (("with memory", "tab:blue"), ("without", "tab:orange")):
        held = sorted((row for row in rows if row["arm"] == arm), key=lambda row: int(row["trial"]))
        number = np.arange(1, len(held) + 1)
        left.plot(number, np.cumsum([row["success"] for row in held]) / number, color=colour, label=arm)
        right.plot(number, np.cumsum([row["advisor_calls"] for row in held]), color=colour, label=arm)
    left.set(xlabel="trial", ylabel="share of successes so far", ylim=(0, 1.02))
    right.set(xlabel="trial", ylabel="advisor calls so far", ylim=(0, None))
    left.legend(frameon=False)
    figure.savefig(path, dpi=120)


def summary(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the totals in lines: all trials, the first ten, the second half, and a sign test of the two arms."""
    trials = 1 + max((int(row["trial"]) for row in rows), default=0)
    lines = []
    for told, some in (
        ("all", range(trials)),
        ("the first ten", range(min(10, trials))),
        ("the second half", range(trials // 2, trials)),
    ):
        for arm in ARMS:
            held = [row for row in rows if row["arm"] == arm and row["trial"] in some]
            lines.append(
                f"{told}, {arm}: {sum(row['success'] for row in held)} of {len(held)} succeeded, "
                f"{sum(row['advisor_calls'] for row in held)} advisor calls, "
                f"{sum(row['memory_hit'] for row in held)} began with a remembered plan"
            )
    won = [{row["trial"] for row in rows if row["arm"] == arm and row["success"]} for arm in ARMS]
    first, second = len(won[0] - won[1]), len(won[1] - won[0])
    lines.append(f"only with memory {first}, only without {second}: p = {sign_test(first, second):.2g}")
    return lines


def main() -> None:
    """Run what is missing of the stream, print the totals, and draw the figure."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--trials", type=int, default=4)
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--advisor", default="sloppy:0.5:heuristic")
    parser.add_argument("--out", type=Path, help="by default a new temporary folder")
    args = parser.parse_args()
    out = args.out or Path(mkdtemp(prefix="lifelong-"))
    out.mkdir(parents=True, exist_ok=True)
    log = out / "trials.jsonl"
    rows = [json.loads(line) for line in log.read_text().splitlines()] if log.exists() else []
    done = {(row["trial"], row["arm"]) for row in rows}
    for k, task in enumerate(stream(args.trials)):
        for arm in ARMS:
            if (k, arm) not in done:
                rows.append(run_trial(task, k, arm, args.advisor, args.samples, out))
                with log.open("a") as file:
                    file.write(json.dumps(rows[-1]) + "\n")
                print(json.dumps(rows[-1]), flush=True)
    print("\n".join(summary(rows)))
    draw(rows, out / "lifelong.png")


if __name__ == "__main__":
    main()
