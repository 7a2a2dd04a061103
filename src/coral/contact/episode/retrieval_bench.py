"""Score of the memory's retrieval on its test set: is the right plan found, is a wrong one offered?"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from coral.contact.episode.retrieval_cases import NOTHING, REMEMBERED, RetrievalCase
from coral.contact.memory.embedding import Embedder
from coral.contact.memory.memory import Experience, Memory, MemoryCfg
from coral.contact.memory.scene_numbers import scene_numbers
from coral.contact.scene.facts import SceneFacts
from coral.contact.scene.prior_beliefs import stated_beliefs
from coral.contact.scene.task import Task
from coral.contact.scene.task_file import load_task_file
from coral.contact.scene.trial import sample_trial
from coral.contact.thinker.recorded_answers import recorded_answers
from coral.contact.thinker.scene_facts import scene_facts
from coral.contact.worlds.hand_world import HandWorld, HandWorldCfg

REMEMBERED_SEED = 100
"""Seed of the trials in the memory."""
ASKED_SEED = 0
"""Seed of the trials for which a plan is looked up."""


@dataclass(frozen=True)
class RetrievalResult:
    """What was found for one case."""

    case: RetrievalCase
    """The case."""
    found: str
    """The task of the first plan offered; `none` if none was."""
    similarity: float
    """Similarity of its instruction; 0 without a plan."""

    @property
    def right(self) -> bool:
        """Return whether the first plan offered would do; no plan, where none should be offered."""
        return self.found in self.case.fits

    @property
    def wrong_offer(self) -> bool:
        """Return whether a plan was offered that would not do."""
        return self.found != NOTHING and not self.right


def retrieve_cases(
    cases: Sequence[RetrievalCase], embedder: Embedder | None = None, cfg: MemoryCfg | None = None
) -> list[RetrievalResult]:
    """Look up a plan for each case, in a memory with one success of each of the tasks `REMEMBERED`.

    Only facts are compared: nothing is simulated, and no plan is rehearsed.

    Args:
        cases: The cases.
        embedder: Embeds the instructions; by default the memory's.
        cfg: Configuration of the memory.
    """
    with TemporaryDirectory() as aside:
        memory = Memory(Path(aside) / "memory.sqlite", cfg, embedder)
        for name in REMEMBERED:
            memory.add(_experience(load_task_file(name)))
        results = []
        for case in cases:
            matches = memory.find(initial_facts(case.task, ASKED_SEED))
            first = matches[0] if matches else None
            results.append(
                RetrievalResult(
                    case,
                    NOTHING if first is None else first.stored.experience.task,
                    0.0 if first is None else first.similarity,
                )
            )
        return results


def rank_by_wording(cases: Sequence[RetrievalCase], embedder: Embedder) -> tuple[int, int]:
    """Count the cases in other words, and those of them whose task has the most similar instruction.

    This is what the embedder alone would find, without goals and numbers.

    Args:
        cases: The cases.
        embedder: Embeds the instructions.
    """
    tasks = {name: load_task_file(name) for name in REMEMBERED}
    known = np.stack([embedder.embed(task.instruction) for task in tasks.values()])
    reworded = [
        one for one in cases if NOTHING not in one.fits and one.task.instruction != tasks[one.origin].instruction
    ]
    nearest = [REMEMBERED[int(np.argmax(known @ embedder.embed(one.task.instruction)))] for one in reworded]
    return len(reworded), sum(name in one.fits for name, one in zip(nearest, reworded, strict=True))


def score_retrieval(results: Sequence[RetrievalResult]) -> dict[str, Mapping[str, int]]:
    """Count the results by kind of change, and all in which a plan should be found (`found`).

    Returns:
        For each kind: `cases`, `right`, `wrong_offers`.
    """
    kinds = list(dict.fromkeys(result.case.change for result in results))
    groups = {kind: [one for one in results if one.case.change == kind] for kind in kinds}
    groups["found"] = [one for one in results if NOTHING not in one.case.fits]
    return {
        kind: {
            "cases": len(held),
            "right": sum(one.right for one in held),
            "wrong_offers": sum(one.wrong_offer for one in held),
        }
        for kind, held in groups.items()
    }


def initial_facts(task: Task, seed: int) -> SceneFacts:
    """Return the facts of a trial at its beginning, with the masses and frictions that its task file suggests."""
    trial = sample_trial(task, seed)
    world = HandWorld(trial, HandWorldCfg())
    try:
        return scene_facts(trial, world.reset(), stated_beliefs(trial))
    finally:
        world.close()


def _experience(task: Task) -> Experience:
    """Return a success of a task with the recorded model's plan."""
    facts, answers = initial_facts(task, REMEMBERED_SEED), recorded_answers(task.name)
    assert answers is not None
    return Experience(
        task=task.name,
        instruction=task.instruction,
        goals=[dict(goal) for goal in facts["goals"]],
        numbers=scene_numbers(facts),
        plan=answers.plan,
        regions=answers.regions,
        beliefs={name: (item["mass_kg"], item["friction"]) for name, item in facts["objects"].items()},
        provenance={"success": True, "world": "hand", "seed": REMEMBERED_SEED},
    )
