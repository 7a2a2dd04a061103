import pytest

from coral.contact.plan.contact_regions import RegionsAnswer
from coral.errors import InputError
from coral.exam import generation
from coral.exam.contact_scenes import trial_from_json
from coral.exam.generation import CONTACT, REEFS, make_set, unseen_items
from coral.exam.item import ANSWERS
from coral.exam.question_set import load_set
from coral.reef.world.world import shipped_worlds

KIND = "physical-parameters"


def test_a_set_says_what_it_was_made_of():
    told = []
    made = make_set("mine", 17, 0, {KIND: 1, "object-poses": 1}, told.append, reefs=())
    assert (made.name, made.about) == ("mine", {"seed": 17, "generated_reefs": 0})
    assert [item.kind for item in made.items] == [KIND, "object-poses"]
    assert told == [f"1 {KIND} questions", "1 object-poses questions"]


def test_the_shipped_set_is_what_its_seed_makes(same):
    shipped = load_set("public", [KIND], 1)
    made = make_set("public", shipped.about["seed"], 0, {KIND: 1}, reefs=())
    same(made.items[0], shipped.items[0])


def test_a_full_set_asks_every_kind_and_uses_shipped_reefs():
    assert set(CONTACT) == {kind for kind in ANSWERS if not kind.startswith("reef-")}
    assert set(REEFS) <= set(shipped_worlds())


def test_a_task_without_a_rule_has_a_question_in_words_and_a_trial_as_its_key(monkeypatch):
    monkeypatch.setattr(generation, "unseen_tasks", lambda half: ("turn-lever",))
    [item] = unseen_items("development", 3)
    assert (item.id, item.kind, item.group) == ("cost-function-000", "cost-function", "turn-lever-3")
    assert "Turn the lever on its post" in item.prompt
    assert len(item.pictures) == 1
    trial = trial_from_json(item.key["trial"])
    assert (trial.task.name, trial.seed) == ("turn-lever", 3)
    assert trial.task.objects[0].joint is not None
    assert RegionsAnswer.model_validate(item.key["regions"]).root == {}


def test_a_half_that_there_is_not_is_refused():
    with pytest.raises(InputError, match="did you mean 'test'"):
        unseen_items("tets", 0)
