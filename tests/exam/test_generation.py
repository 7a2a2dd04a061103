from coral.exam.generation import CONTACT, REEFS, make_set
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
