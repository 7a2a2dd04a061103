"""How many lengths of a remembered plan become right in another scene, number by number.

    python benchmarks/contact_adaptation.py --half test

The rules write a plan for each remembered task and another one for each changed task of the memory's test set (`coral
memory bench`). The first plan is adapted to the second scene, and its lengths are compared with those that the rules
write there, to 0.3 mm. Only plans with the same stages and as many lengths can be compared. Nothing is simulated.
"""

from __future__ import annotations

import argparse
from collections import Counter

from coral.contact.episode.retrieval_bench import ASKED_SEED, REMEMBERED_SEED, initial_facts
from coral.contact.episode.retrieval_cases import NOTHING, load_retrieval_cases
from coral.contact.memory.adaptation import adapt
from coral.contact.memory.expressions import PROGRAMS, Length, find_expressions, lengths_in
from coral.contact.memory.goal_match import match_goals
from coral.contact.memory.memory import Experience
from coral.contact.memory.scene_numbers import scene_numbers
from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.rules.composition import compose
from coral.contact.rules.goals import NoRule
from coral.contact.scene.task import Task
from coral.contact.scene.task_file import load_task_file

RIGHT_M = 3e-4


def compare(before: Task, after: Task) -> Counter[str]:
    """Adapt the rules' plan for one task to another, and count its lengths by what became of them."""
    there, here = initial_facts(before, REMEMBERED_SEED), initial_facts(after, ASKED_SEED)
    goals = match_goals(there["goals"], here["goals"])
    try:
        written, wanted = compose(there), compose(here)
    except NoRule:
        return Counter({"no rule": 1})
    numbers = scene_numbers(there)
    held = Experience(
        task=before.name,
        instruction=before.instruction,
        goals=[dict(goal) for goal in there["goals"]],
        numbers=numbers,
        plan=written.plan,
        regions=written.regions,
        beliefs=dict.fromkeys(there["objects"], (0.2, 0.5)),
        provenance={},
        expressions=find_expressions(written.plan, numbers),
    )
    assert goals is not None
    adapted, _ = adapt(held, here, goals)
    old, new, right = (_lengths(plan) for plan in (written.plan, adapted, wanted.plan))
    if not len(old) == len(new) == len(right):
        return Counter({"another structure": 1})
    return Counter(_fate(*(float(one.text) for one in three)) for three in zip(old, new, right, strict=True))


def _lengths(plan: PlanAnswer) -> list[Length]:
    return [one for stage in plan.each() for field in PROGRAMS for one in lengths_in(getattr(stage, field))]


def _fate(old: float, new: float, wanted: float) -> str:
    if abs(old - wanted) <= RIGHT_M:
        return "same there: kept" if abs(new - wanted) <= RIGHT_M else "same there: changed"
    if abs(new - wanted) <= RIGHT_M:
        return "other there: computed"
    return "other there: kept" if abs(new - old) <= RIGHT_M else "other there: computed wrongly"


def main() -> None:
    """Print the counts over a half of the test set."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--half", default="development")
    total: Counter[str] = Counter()
    for case in load_retrieval_cases(parser.parse_args().half):
        if NOTHING not in case.fits:
            total += compare(load_task_file(case.origin), case.task)
    for fate, count in sorted(total.items()):
        print(f"{fate:<30}{count:>6}")


if __name__ == "__main__":
    main()
