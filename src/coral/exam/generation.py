"""Making a set of questions; the same seed makes the same set."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from coral.exam.contact_questions import contact_items
from coral.exam.question_set import QuestionSet
from coral.exam.reef_questions import reef_items

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
"""How many questions of each kind; those that are scored by an episode are few, so that a bench takes minutes."""


def make_set(
    name: str,
    seed: int,
    generated: int,
    contact: Mapping[str, int],
    say: Callable[[str], None] = lambda text: None,
    reefs: tuple[str, ...] = REEFS,
) -> QuestionSet:
    """Make a set.

    Args:
        name: For tables.
        seed: Of worlds, ways through them, and trials.
        generated: How many reefs to generate besides the shipped ones.
        contact: How many contact questions of each kind.
        say: Told of each step.
        reefs: Shipped reefs that are used.
    """
    items = [*reef_items(seed, generated, reefs, say), *contact_items(seed, contact, say)]
    return QuestionSet(name=name, about={"seed": seed, "generated_reefs": generated}, items=tuple(items))
