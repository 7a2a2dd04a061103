import pytest

from coral.contact.memory.memory import Experience, Memory
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer


def experience(**provenance):
    return Experience(
        task="pick-box",
        instruction="Pick up the box.",
        goals=[{"kind": "lifted", "object": "box"}],
        numbers={"box.mass_kg": 0.2},
        plan=PlanAnswer(code="def state_cost(self):\n    return 1.0"),
        regions=RegionsAnswer({}),
        beliefs={"box": (0.2, 0.5)},
        provenance={"success": True, "world": "hand", "seed": 3, **provenance},
    )


@pytest.fixture
def place(tmp_path):
    """Where a memory of some name is to be."""
    return lambda name: str(tmp_path / f"{name}.sqlite")


@pytest.fixture
def memory(place):
    """A memory of one experience."""
    memory = Memory(place("m"))
    memory.add(experience())
    return memory


def test_what_is_remembered_is_listed_and_shown(told, memory):
    (number,) = [stored.id for stored in memory.all()]
    code, result, _ = told("memory", "list", "--file", memory.where, "--json")
    assert code == 0
    assert [(row["id"], row["task"], row["world"], row["seed"]) for row in result["experiences"]] == [
        (number, "pick-box", "hand", 3)
    ]
    code, text, _ = told("memory", "show", number, "--file", memory.where)
    assert (code, text.count("def state_cost(self):")) == (0, 1)
    assert "task: pick-box" in text.splitlines()


def test_the_rate_of_success_is_listed(told, memory):
    (number,) = [stored.id for stored in memory.all()]
    assert "not used yet" in told("memory", "list", "--file", memory.where)[1]
    for helped in (True, False):
        memory.used(number, helped)
    assert "helped 1 of 2" in told("memory", "list", "--file", memory.where)[1]
    (row,) = told("memory", "list", "--file", memory.where, "--json")[1]["experiences"]
    assert row["success_rate"] == 0.5


def test_provenance_that_says_little_or_too_much_is_listed_all_the_same(told, memory):
    number = memory.add(experience(seed=4, id=77).model_copy(update={"provenance": {"success": True, "world": "hand"}}))
    lines = told("memory", "list", "--file", memory.where)[1].splitlines()
    assert {line.split()[0] for line in lines} >= {str(number)}
    assert any("seed None" in line for line in lines)


def test_one_that_is_forgotten_is_gone_and_one_that_is_not_there_is_named(told, refused, memory):
    (number,) = [stored.id for stored in memory.all()]
    assert "99" in refused("memory", "forget", 99, "--file", memory.where)
    assert told("memory", "forget", number, "--file", memory.where)[0] == 0
    assert told("memory", "list", "--file", memory.where)[1] == f"{memory.where}: nothing is remembered\n"


@pytest.mark.parametrize("words", [("list",), ("show", "1"), ("forget", "1")])
def test_a_memory_that_is_not_there_is_not_made(refused, place, tmp_path, words):
    error = refused("memory", *words, "--file", place("none"))
    assert "found no such" in error
    assert list(tmp_path.iterdir()) == []
