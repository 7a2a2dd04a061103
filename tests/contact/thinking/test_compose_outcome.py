import numpy as np
import pytest

from coral.contact.draw import draw
from coral.contact.hand_world import HandWorld, HandWorldCfg
from coral.contact.planning import PlanningCfg, PlanningWorld
from coral.contact.scene import prior
from coral.contact.task import load_task, shipped_tasks
from coral.contact.thinking.compose_outcome import outcome_plan
from coral.contact.thinking.plan_answer import verify_plan
from coral.contact.thinking.rehearse import sample_states
from coral.contact.thinking.rules import RULES
from coral.contact.thinking.scene_facts import scene_facts


def scene(name):
    drawn = draw(load_task(name), 0)
    first = HandWorld(drawn, HandWorldCfg()).reset()
    world = PlanningWorld(drawn, prior(drawn), first, PlanningCfg(threads=1))
    sizes = {thing: drawn.size(thing) for thing in drawn.objects}
    return scene_facts(drawn, first, prior(drawn)), world, sample_states(world, first, sizes, np.random.default_rng(0))


@pytest.mark.parametrize("name", shipped_tasks())
def test_a_cost_of_outcomes_alone_can_be_used_and_says_nothing_of_where_to_touch(name):
    facts, world, samples = scene(name)
    plan = outcome_plan(facts)
    assert verify_plan(plan, world.schema, samples) is None
    drawn = [line.split(" = ")[1].split(" - 0.")[0] for line in plan.code.splitlines() if "ee_" in line]
    assert set(drawn) <= {f"8.0 * clip(norm(self.ee_pos - self.{thing}_pos)" for thing in facts["objects"]}


def test_the_rules_answer_so_where_there_is_to_be_no_contact_strategy():
    facts, _, _ = scene("flip-wall")
    asked = {**facts, "contact_strategy": False}
    assert RULES["cost-function"](asked, ()) == outcome_plan(facts) == RULES["cost-repair"](
        {**asked, "diagnoses": ["no-progress"]}, ()).model_copy(update={"explanation": outcome_plan(facts).explanation})
    assert RULES["contact-regions"](asked, ()).root == {}


def test_goals_that_ask_for_nothing_to_be_moved_make_no_cost():
    assert outcome_plan({"goals": [{"kind": "undisturbed", "object": "box"}]}) is None
