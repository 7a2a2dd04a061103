"""What plans for the unseen tasks are worth: recorded answers of a reader outside, or plans without a thought.

    python benchmarks/unseen_reader.py --seed 0 --answers docs/research/contact-unseen-reader.jsonl
    python benchmarks/unseen_reader.py --seed 0 --control hover
    python benchmarks/unseen_reader.py --seed 1 --answers docs/research/contact-unseen-reader-1.jsonl --noise 1

Each plan is checked and followed as `coral advisor bench` does, once, without repairs. `hover` is one cost for all
tasks, to stay where the hand is; `greedy` has two terms, the hand's distance to the first goal's object and the
object's to its place, or from where it was. `--noise` sets the factor of all stages, `--guided-slowest` and `--samples`
those of the planner: to find out why a plan failed.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from coral.contact.cost_program import CostError, CostWorker
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.plan.cost_plan import PlanAnswer
from coral.exam.contact_outcome import follow, followed_plan, scored_cfg
from coral.exam.contact_scenes import trial_from_json
from coral.exam.generation import unseen_items

HOVER = "def state_cost(self):\n    return norm(self.ee_pos - self.ee_stage_pos) + norm(self.ee_vel)"
GREEDY = "def state_cost(self):\n    return {{'reach': 5.0 * norm(self.ee_pos - self.{0}_pos), 'goal': {1}}}"


def main() -> None:
    """Follow the plans and print what became of each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=0, help="of the questions")
    parser.add_argument("--half", choices=("development", "test"), default="test", help="of the unseen suite")
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument("--answers", type=Path, help="a line for each question, in their order: {answer: ...}")
    source.add_argument("--control", choices=("hover", "greedy"))
    parser.add_argument("--only", default="", help="names of tasks, separated by commas")
    parser.add_argument("--noise", type=float)
    parser.add_argument("--guided-slowest", type=float)
    parser.add_argument("--samples", type=int)
    said = parser.parse_args()
    items = unseen_items(said.half, said.seed)
    if said.answers:
        answers = [json.loads(line)["answer"] for line in said.answers.read_text(encoding="utf-8").splitlines()]
    else:
        answers = [{"code": control_of(said.control, item.facts)} for item in items]
    only, solved, asked = set(filter(None, said.only.split(","))), 0, 0
    print("| task | success | end | time (s) |\n|---|---|---|---:|", flush=True)
    for item, answer in zip(items, answers, strict=True):
        task = item.facts["task"]
        if only and task not in only:
            continue
        result = outcome(item.key, with_noise(PlanAnswer.model_validate(answer), said.noise), cfg_of(said))
        solved, asked = solved + bool(result["success"]), asked + 1
        end = result["detail"] or result["end_reason"]
        print(f"| {task} | {bool(result['success'])} | {end} | {result['sim_time_s']:.1f} |", flush=True)
    print(f"{solved} of {asked}")


def control_of(name: str, facts: Mapping[str, Any]) -> str:
    """Write the cost of a control."""
    if name == "hover":
        return HOVER
    thing = facts["goals"][0]["object"]
    place = next((goal["place"] for goal in facts["goals"] if goal.get("place") in facts["places"]), None)
    moved = f"-20.0 * norm(self.{thing}_pos - self.{thing}_init_pos)"
    return GREEDY.format(thing, moved if place is None else f"20.0 * norm(self.{thing}_pos - self.{place}_pos)")


def with_noise(plan: PlanAnswer, noise: float | None) -> PlanAnswer:
    """Return the plan with this factor in each stage, if there is one."""
    if noise is None:
        return plan
    return plan.model_copy(update={"stages": [one.model_copy(update={"noise": noise}) for one in plan.stages]})


def cfg_of(said: argparse.Namespace) -> EpisodeCfg:
    """Return the configuration of a scored episode with the changes that were asked for."""
    cfg = scored_cfg()
    controller = cfg.controller
    if said.guided_slowest is not None:
        controller = replace(controller, guided_slowest=said.guided_slowest)
    if said.samples is not None:
        controller = replace(controller, mppi=replace(controller.mppi, samples=said.samples))
    return replace(cfg, controller=controller)


def outcome(key: Mapping[str, Any], plan: PlanAnswer, cfg: EpisodeCfg) -> dict[str, Any]:
    """Follow one plan."""
    with CostWorker() as worker:
        try:
            return follow(trial_from_json(key["trial"]), followed_plan(key, plan), worker.load, cfg=cfg)
        except CostError as error:
            return {"success": False, "end_reason": "refused", "detail": error.code, "sim_time_s": 0.0}


if __name__ == "__main__":
    main()
