"""How often the check of costs accepts costs that are known to be good.

    python benchmarks/contact_checks.py --trials 100 --kinds prompt,example,listing,expert
    python benchmarks/contact_checks.py --trials 100 --kinds prompt,example --tasks unseen
    python benchmarks/contact_checks.py --kinds bad       # costs that have to be refused
    python benchmarks/contact_checks.py                   # ten trials of the six tasks, all good kinds

The costs: the worked example of the prompt and the shortest cost that a person would write, adapted to each scene; the
paper's listing for the board; the experts' costs, as one stage and as state machines;
the plans of the recorded reader. Every stage of them is checked in the opening scene of each trial.

From trial to trial the scene varies: poses, sizes, masses, frictions, the start of a joint. A verdict draws no random
number, so a second one of the same scene can only confirm the first: the first trials (`--twice`) are checked again,
with states that are sampled anew, and no more.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import textwrap
from collections import defaultdict
from collections.abc import Collection, Iterator
from pathlib import Path

import numpy as np

from coral.advisor.prompt import FOLDER
from coral.advisor.recorded_attempts import SHIPPED, read_attempts
from coral.contact.control.planning_world import PlanningCfg, PlanningWorld
from coral.contact.cost.context import Context, Cost, Schema, Terms
from coral.contact.cost_program import CostProgram
from coral.contact.cost_program.errors import CostError
from coral.contact.experts import Kind, expert
from coral.contact.plan.barrier_check import CostFault
from coral.contact.plan.cost_check import verify_cost
from coral.contact.plan.cost_plan import PlanAnswer, compile_stage
from coral.contact.plan.sampled_states import sample_states
from coral.contact.scene.task_names import suite_tasks
from coral.contact.scene.trial import Trial, sample_trial, stated_beliefs
from coral.contact.tasks import load_task
from coral.contact.thinker.scene_facts import scene_facts
from coral.contact.worlds.hand_world import HandWorld

TASKS = ("push-pick-board", "pick-box", "pick-clutter", "push-force", "flip-box", "flip-wall")
KINDS = ("prompt", "example", "listing", "expert", "reader")
EXAMPLE = textwrap.dedent("""
    def state_cost(self):
        cost = 10.0 * np.linalg.norm(self.{name}_pos[:2] - {goal}[:2])
        cost += 2.0 * np.linalg.norm(self.ee_pos - self.{name}_pos)
        cost += 0.001 * np.dot(self.last_action, self.last_action)
        return cost
""").strip()
"""The shortest cost that a person would write: the goal, the way to the object, a little effort."""
ABSOLUTE = textwrap.dedent("""
    def state_cost(self):
        away = self.ee_pos - self.{name}_pos
        gone = self.{name}_pos - {goal}
        cost = 10.0 * (abs(gone[0]) + abs(gone[1]))
        return cost + 2.0 * (abs(away[0]) + abs(away[1]) + abs(away[2]))
""").strip()
"""The same with absolute values in place of norms."""
BOARD = textwrap.dedent("""
    def state_cost(self):
        pos, hand_pos = self.board_pos, self.ee_pos
        speed, spin = self.board_vel, self.board_angvel
        forward = np.array([0.0, 1.0, 0.0])
        grip = np.array(self.board_handle_pos)
        beyond = np.dot(grip - np.array([grip[0], self.table_max[1], grip[2]]), forward)
        done = max(0.0, min(1.0, float(beyond / self.overhang)))
        motion = np.linalg.norm(speed) + 0.4 * np.linalg.norm(spin)
        calm = np.exp(-2.5 * motion)
        s = 1.0 / (1.0 + np.exp(-10.0 * (0.6 * done + 0.4 * calm - 0.5)))
        press = pos + 0.5 * self.overhang * forward
        cost = 11.0 * (1.0 - s) * np.linalg.norm(hand_pos - press)  # press
        cost += 19.0 * s * np.linalg.norm(hand_pos - grip)  # grip
        cost -= 15.0 * (1.0 - s) * done  # push
        touching = bool(self.board_hand_contact)
        cost += (20.0 * (1.0 - s)) * (0.0 if touching else 1.0)  # touch
        moved = pos - np.array(self.board_init_pos)
        along = np.dot(moved, forward) * forward
        cost += 9.0 * (1.0 - s) * np.linalg.norm(moved - along)  # drift
        lift = pos[2] - self.board_init_pos[2]
        cost -= (30.0 * s) * max(0.0, float(lift))  # lift
        cost += 0.001 * np.linalg.norm(self.last_action) ** 2  # effort
        return cost
""").strip()
"""The paper's Listing 1 (A.6) in our own words: press and push, then grip and lift, blended by a sigmoid."""


BAD = {
    "the same everywhere": "return {{'pay': 1.0}}",
    "not finite": "return {{'log': np.log(self.{name}_pos[2] - 10.0)}}",
    "a vector": "return {{'way': self.ee_pos - self.{name}_pos}}",
    "no such thing": "return {{'way': norm(self.ee_pos - self.nobody_pos)}}",
    "a wall about the object": "d = norm(self.ee_pos - self.{name}_pos)\n"
    "    return {{'go': 5.0 * d + 100.0 * (d < 0.1)}}",
}
"""Costs that no planner can use."""


class Opening:
    """The opening scene of one trial.

    Args:
        task: The task.
        seed: Of the trial.
    """

    def __init__(self, task: str, seed: int) -> None:
        self.trial = sample_trial(load_task(task), seed)
        world = HandWorld(self.trial)
        self.now = world.reset()
        world.close()
        beliefs = stated_beliefs(self.trial)
        self.planner = PlanningWorld(self.trial, beliefs, self.now, PlanningCfg(threads=1))
        self.facts = scene_facts(self.trial, self.now, beliefs)
        self.samples = self.sample()
        self.schema: Schema = self.planner.schema

    def sample(self) -> Context:
        """Sample the states on which costs are checked."""
        sizes = {name: self.trial.size(name) for name in self.trial.objects}
        return sample_states(self.planner, self.now, sizes)

    def close(self) -> None:
        """Stop the planning world's threads."""
        self.planner.close()


class _Written:
    """An expert's function as a cost."""

    def __init__(self, name: str, function: object) -> None:
        self.name, self._function = name, function

    def __call__(self, state: Context) -> Terms:
        return self._function(state)  # type: ignore[operator,no-any-return]


def prompt_example(trial: Trial) -> PlanAnswer:
    """Return the worked example of the prompt, about the first object of a trial."""
    text = (FOLDER / "parts" / "plan-example.md").read_text(encoding="utf-8")
    found = re.search(r"{% raw %}(.*){% endraw %}", text, re.DOTALL)
    assert found is not None
    name = next(iter(trial.objects))
    plan = found[1]
    plan = plan.replace('{"puck": "red"}, {"puck": "blue"}', f'{{"puck": "{name}"}}')
    if "goal" not in trial.task.places:
        plan = plan.replace("self.goal_pos", f"(self.{name}_init_pos + np.array([0.1, 0.0, 0.0]))")
    return PlanAnswer.model_validate_json(plan)


def good_costs(opening: Opening, task: str, kinds: Collection[str] = KINDS) -> Iterator[tuple[str, Cost]]:
    """Yield the costs that are known to be good, by what they are; `kinds` are the first words of it."""
    wanted = {kind: kind in kinds for kind in KINDS}
    if wanted["prompt"]:
        for stage in prompt_example(opening.trial).each():
            yield "prompt", compile_stage(stage, opening.schema).cost
    yield from _written_by_persons(opening, task, wanted)
    plans: list[tuple[str, PlanAnswer | None]] = []
    if wanted["reader"]:
        plans += [("reader", plan) for plan in _reader_plans(task)]
    for kind, plan in plans:
        if plan is not None:
            for stage in plan.each():
                yield kind, compile_stage(stage, opening.schema).cost


def _written_by_persons(opening: Opening, task: str, wanted: dict[str, bool]) -> Iterator[tuple[str, Cost]]:
    name = next(iter(opening.trial.objects))
    goal = _goal(opening.trial, name)
    if wanted["example"]:
        for kind, text in (("example", EXAMPLE), ("example, with abs", ABSOLUTE)):
            yield kind, CostProgram(text.format(name=name, goal=goal), opening.schema)
    if wanted["listing"] and task == "push-pick-board":
        yield "listing", CostProgram(BOARD, opening.schema)
    if wanted["expert"]:
        forms: tuple[Kind, ...] = ("expert", "expert-fsm") if task in TASKS else ()
        for form in forms:
            for stage in expert(opening.trial.task, form).stages:
                yield form, _Written(stage.name, stage.cost)


def bad_costs(opening: Opening) -> Iterator[tuple[str, Cost | None]]:
    """Yield the costs that have to be refused; None for one that does not compile."""
    name = next(iter(opening.trial.objects))
    for kind, text in BAD.items():
        try:
            yield f"bad, {kind}", CostProgram(f"def state_cost(self):\n    {text.format(name=name)}", opening.schema)
        except CostError:
            yield f"bad, {kind}", None


def _goal(trial: Trial, name: str) -> str:
    places = list(trial.task.places)
    return f"self.{places[0]}_pos" if places else f"(self.{name}_init_pos + np.array([0.1, 0.0, 0.1]))"


def _reader_plans(task: str) -> list[PlanAnswer]:
    path = Path(SHIPPED / f"contact-{task}.jsonl")
    if not path.exists():
        return []
    kept = [one for one in read_attempts(path, task) if one["kind"] in ("cost-function", "cost-repair")]
    return [PlanAnswer.model_validate(one["answer"]) for one in kept if one["verdict"] == "accepted"]


def fatal(cost: Cost | None, samples: Context) -> list[CostFault]:
    """Return the faults that refuse a cost."""
    if cost is None:
        return [CostFault("unknown", 0, "it does not compile")]
    return [fault for fault in verify_cost(cost, samples) if fault.fatal]


def main() -> None:
    """Print accepted and checked costs by kind and task, and how many had two verdicts."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=10, help="trials of each task")
    parser.add_argument("--tasks", default=",".join(TASKS), help="names, or unseen: that suite")
    parser.add_argument("--kinds", default=",".join(KINDS), help="which costs: bad, " + ", ".join(KINDS))
    parser.add_argument("--twice", type=int, default=3, help="trials of each task that are checked again")
    parser.add_argument("--verbose", action="store_true", help="print every refusal")
    args = parser.parse_args()
    counts: dict[tuple[str, str], list[int]] = defaultdict(lambda: [0, 0, 0])
    for task in suite_tasks("unseen") if args.tasks == "unseen" else args.tasks.split(","):
        for seed in range(args.trials):
            opening = Opening(task, seed)
            again = opening.sample() if seed < args.twice else None
            kinds = args.kinds.split(",")
            bad = bad_costs(opening) if "bad" in kinds else ()
            for kind, cost in (*good_costs(opening, task, kinds), *bad):
                first = fatal(cost, opening.samples)
                second = first if again is None else fatal(cost, again)
                row = counts[kind, task]
                row[0] += not first
                row[1] += 1
                row[2] += first != second
                if first and args.verbose:
                    print(
                        json.dumps(
                            [task, seed, kind, "" if cost is None else cost.name, [fault.reason for fault in first]]
                        )
                    )
            opening.close()
        rows = [row for (_, of), row in counts.items() if of == task]
        good, all_, two = np.sum(rows, axis=0)
        print(f"{task}: accepted {good} of {all_}, two verdicts {two}", file=sys.stderr, flush=True)
    print("| cost | task | accepted | checked | two verdicts |\n|---|---|---|---|---|")
    for (kind, task), (good, all_, two) in sorted(counts.items()):
        print(f"| {kind} | {task} | {good} | {all_} | {two} |")
    print(f"accepted {np.sum([row[0] for row in counts.values()])} of {np.sum([row[1] for row in counts.values()])}")


if __name__ == "__main__":
    main()
