"""What a plan says briefly is written out, within limits."""

import re
from pathlib import Path

import pytest
from pydantic import ValidationError

from coral.advisor.prompt import FOLDER
from coral.contact.control.quantities import task_schema_of
from coral.contact.episode.own_cost import read_cost_file
from coral.contact.plan.cost_plan import PlanAnswer, compile_stage
from coral.contact.plan.plan_language import MOST_STAGES, write_out
from coral.contact.tasks import load_task

EXAMPLES = Path(__file__).parents[3] / "examples"

CODE = "def state_cost(self):\n    return {'off': norm(self.{can}_pos - {spot})}"
LOOP = {"for": [{"can": "red"}, {"can": "blue"}], "stages": [{"name": "take {can}", "code": CODE, "done": "1 > 0"}]}


def test_a_loop_stands_for_its_stages_once_for_each_entry_and_names_for_their_expressions():
    last = {"name": "leave", "code": "def state_cost(self):\n    return {spot}[2]", "next": {"take red": "{high} > 1"}}
    plan = PlanAnswer.model_validate({"let": {"spot": "self.goal_pos", "high": "{spot}[2]"}, "stages": [LOOP, last]})
    assert plan.names == ["take red", "take blue", "leave"]
    assert "norm(self.blue_pos - (self.goal_pos))" in plan.stages[1].code
    assert plan.stages[2].next == {"take red": "((self.goal_pos)[2]) > 1"}
    assert plan.let == {}
    assert PlanAnswer.model_validate(plan.model_dump()) == plan


def test_a_name_may_use_what_a_loop_gives():
    plan = write_out({"let": {"spot": "self.{can}_init_pos"}, "stages": [LOOP]})
    assert "self.red_pos - (self.red_init_pos)" in plan["stages"][0]["code"]


def test_a_plan_without_names_and_loops_is_left_as_it_is():
    plain = {"stages": [{"name": "a", "code": "def state_cost(self):\n    return {x}"}], "explanation": "y"}
    assert write_out(plain) == plain
    assert write_out({"code": "x"}) == {"code": "x"}


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"stages": [LOOP]}, "uses {spot}, which neither `let` nor `for` defines; they define can"),
        ({"let": {"spto": "1"}, "stages": [LOOP]}, "uses {spot} (did you mean 'spto'?), which neither"),
        ({"let": {"spot": "1"}, "stages": [{"for": [], "stages": []}]}, "a loop is"),
        ({"let": {"spot": "1"}, "stages": [{"for": [{"can": "a"}], "stages": [LOOP]}]}, "no other loop"),
        ({"let": {"Spot": "1"}, "stages": [LOOP]}, "no small name"),
        ({"let": {"spot": "1"}, "stages": ["a", LOOP]}, "is an object"),
        (
            {"let": {"spot": "1"}, "stages": [{**LOOP, "for": [{"can": "a"}] * 65}]},
            f"than {MOST_STAGES}",
        ),
        ({"let": {"a": "x" * 99, **{f"a{k}": "{a}" * 400 for k in range(9)}}, "stages": [LOOP]}, "20000 characters"),
        ({"let": {f"n{k}": "1" for k in range(33)}, "stages": [LOOP]}, "at most 32 names"),
    ],
)
def test_what_cannot_be_written_out_is_refused(given, words):
    with pytest.raises(ValidationError, match=re.escape(words)):
        PlanAnswer.model_validate(given)


def test_a_schema_tells_of_loops_and_names():
    schema = PlanAnswer.model_json_schema()["properties"]
    assert len(schema["stages"]["items"]["anyOf"]) == 2
    assert "let" in schema


def test_the_swap_of_two_cans_is_less_than_half_as_long():
    """The recorded swap, without names and loops, has 12 900 characters."""
    file = EXAMPLES / "swap-cans-plan.yaml"
    plan, task = read_cost_file(file), load_task("swap-cans")
    assert len([compile_stage(stage, task_schema_of(task)) for stage in plan.each()]) == 18
    assert len(file.read_text()) < 12_900 / 2


def test_the_example_of_the_prompt_is_a_plan():
    text = (FOLDER / "parts/plan-example.md").read_text()
    plan = PlanAnswer.model_validate_json(re.search(r"{% raw %}(.*){% endraw %}", text, re.S)[1])
    assert plan.names == ["behind red", "push red", "behind blue", "push blue"]
