"""Generation of a set of questions; the same seed makes the same set."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from coral.contact.scene.task_file import unseen_tasks
from coral.exam.contact_questions import contact_items, plan_question
from coral.exam.item import ExamItem
from coral.exam.kind_questions import kind_items
from coral.exam.question_set import QuestionSet
from coral.exam.reef_questions import reef_items
from coral.exam.word_questions import word_items

REEFS = ("l1", "l2", "s1", "s2", "k1", "k2", "e1", "e2", "o1", "o2")
CONTACT: Mapping[str, int] = {
    "physical-parameters": 54,
    "contact-regions": 48,
    "object-poses": 42,
    "parameter-repair": 12,
    "cost-function": 12,
    "cost-repair": 6,
    "unified": 6,
}
"""Number of questions of each kind; few of those that an episode scores, so that a bench takes minutes."""


def make_set(
    name: str,
    seed: int,
    generated: int,
    contact: Mapping[str, int],
    say: Callable[[str], None] = lambda text: None,
    reefs: tuple[str, ...] = REEFS,
) -> QuestionSet:
    """Generate a set of questions.

    Args:
        name: Name of the set, for tables.
        seed: Of worlds, paths through them, and trials.
        generated: Number of reefs to generate besides the shipped ones.
        contact: Number of contact questions of each kind.
        say: Receives progress messages.
        reefs: Shipped reefs to use.
    """
    items = [*reef_items(seed, generated, reefs, say), *contact_items(seed, contact, say)]
    return QuestionSet(name=name, about={"seed": seed, "generated_reefs": generated}, items=tuple(items))


def make_unseen_set(name: str, half: str, seed: int) -> QuestionSet:
    """Make a set with one question for a plan of each task in a half of the unseen suite; see `unseen_items`."""
    return QuestionSet(name=name, about={"seed": seed, "unseen": half}, items=tuple(unseen_items(half, seed)))


def make_word_set(name: str, half: str, seed: int, each: int) -> QuestionSet:
    """Make a set of questions of missions in words; see `word_items`."""
    return QuestionSet(name=name, about={"seed": seed, "words": half}, items=tuple(word_items(half, seed, each)))


def make_kind_set(name: str, water: str, distance_m: float, seed: int, each: int) -> QuestionSet:
    """Make a set of pictures of every kind of thing; see `kind_items`."""
    items = tuple(kind_items(water, distance_m, seed, each))
    return QuestionSet(name=name, about={"seed": seed, "kinds": water, "distance_m": distance_m}, items=items)


def unseen_items(half: str, seed: int) -> list[ExamItem]:
    """Make one question for a plan of each task, which a reader outside answers and an episode scores.

    Args:
        half: "development" or "test".
        seed: Of the trials.

    Raises:
        InputError: There is no such half.
    """
    items = [(task, plan_question(task, seed)) for task in unseen_tasks(half)]
    return [
        replace(item, id=f"{item.kind}-{number:03d}", group=f"{task}-{seed}")
        for number, (task, item) in enumerate(items)
    ]
