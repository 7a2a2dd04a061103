import pytest

from coral.exam.contact_questions import TASKS, contact_items
from coral.exam.question_set import load_set

SEED = 17
"""Of the shipped set."""


@pytest.mark.parametrize("kind", ["physical-parameters", "object-poses"])
def test_the_first_question_of_a_kind_is_the_shipped_one(kind, same):
    """The others hold beliefs, plans and pictures of the time when the set was made."""
    (shipped,) = load_set("public", [kind], 1).items
    (made,) = contact_items(SEED, {kind: 1})
    same(made, shipped)


def test_questions_are_numbered_and_each_is_of_another_task():
    told = []
    items = contact_items(SEED, {"contact-regions": 3, "cost-function": 0}, told.append)
    assert [item.id for item in items] == [f"contact-regions-{k:03d}" for k in range(3)]
    assert [item.group for item in items] == [f"{task}-0" for task in TASKS[:3]]
    assert told == ["3 contact-regions questions", "0 cost-function questions"]


def test_another_seed_makes_another_question():
    (one,), (other,) = (contact_items(seed, {"object-poses": 1}) for seed in (1, 2))
    assert one.key != other.key
    assert one.pictures != other.pictures
