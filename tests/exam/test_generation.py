"""The shipped set is what its command makes."""

import json

import pytest

from coral.advisor.log import plain_json
from coral.exam.contact_questions import contact_items
from coral.exam.question_set import load_set
from coral.exam.reef_questions import reef_items


def same(made, shipped):
    assert (made.kind, made.group, made.prompt) == (shipped.kind, shipped.group, shipped.prompt)
    assert json.loads(plain_json(made.facts)) == shipped.facts
    assert json.loads(plain_json(made.key)) == shipped.key
    assert [p.caption for p in made.pictures] == [p.caption for p in shipped.pictures]


@pytest.mark.parametrize("kind", ["physical-parameters", "contact-regions", "object-poses", "cost-function", "unified"])
def test_first_contact_question(kind):
    seed = 17
    shipped = next(item for item in load_set("public", [kind], 1).items)
    made = contact_items(seed, {kind: 1})[0]
    assert made.id == shipped.id
    same(made, shipped)


def test_first_reef_questions():
    made = {item.kind: item for item in reversed(reef_items(17, 0, ("l1",)))}
    for shipped in load_set("public", list(made), 1).items:
        same(made[shipped.kind], shipped)
