import numpy as np
import pytest

from coral.contact.control.planning_world import PlanningCfg, PlanningWorld
from coral.contact.cost.context import Context
from coral.contact.cost_program import CostProgram
from coral.contact.plan.plan_check import verify_plan
from coral.contact.plan.rehearsal import sample_states
from coral.contact.rules.outcome_cost import outcome_plan
from coral.contact.scene.geometry import from_rotvec, multiply
from coral.contact.scene.prior_beliefs import stated_beliefs
from coral.contact.scene.task_file import shipped_tasks
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.scene_facts import scene_facts
from coral.contact.worlds.hand_world import HandWorld, HandWorldCfg


def scene(name):
    trial = sample_trial(load_task(name), 0)
    first = HandWorld(trial, HandWorldCfg()).reset()
    world = PlanningWorld(trial, stated_beliefs(trial), first, PlanningCfg(threads=1))
    sizes = {thing: trial.size(thing) for thing in trial.objects}
    return (
        scene_facts(trial, first, stated_beliefs(trial)),
        world,
        sample_states(world, first, sizes),
    )


@pytest.mark.parametrize("name", shipped_tasks())
def test_a_cost_of_outcomes_alone_can_be_used_and_says_nothing_of_where_to_touch(name):
    facts, world, samples = scene(name)
    plan = outcome_plan(facts)
    assert verify_plan(plan, world.schema, samples) is None
    trial = [line.split(" = ")[1].split(" - 0.")[0] for line in plan.code.splitlines() if "ee_" in line]
    assert set(trial) <= {f"8.0 * clip(norm(self.ee_pos - self.{thing}_pos)" for thing in facts["objects"]}


def test_goals_that_ask_for_nothing_to_be_moved_make_no_cost():
    assert outcome_plan({"goals": [{"kind": "undisturbed", "object": "box"}]}) is None


def test_once_the_other_goals_are_met_letting_go_is_cheaper_and_far_away_costs_nothing():
    facts, world, samples = scene("flip-wall")
    program = CostProgram(outcome_plan(facts).code, world.schema)
    first = samples[0].first()
    values = {name: first[name] for name in first.names()}
    turned = multiply(from_rotvec([0.0, np.pi / 2, 0.0]), values["box_init_quat"][0, 0])[None, None]
    one = np.ones((1, 1))

    def cost(quat, touched, away):
        state = {
            **values,
            "box_quat": quat,
            "box_wall_contact": one,
            "box_vel": np.zeros((1, 1, 3)),
            "box_hand_contact": touched * one,
            "ee_pos": values["box_pos"] + np.array([0.0, 0.0, away]),
        }
        return float(sum(term[0, 0] for term in program(Context(state, (1, 1))).values()))

    assert cost(turned, 1, 0.03) > cost(turned, 0, 0.03) + 0.5
    assert cost(turned, 0, 0.4) == pytest.approx(cost(turned, 0, 0.03), abs=0.01)
    lying = values["box_init_quat"]
    assert cost(lying, 1, 0.03) == pytest.approx(cost(lying, 0, 0.03), abs=0.01)
    assert cost(lying, 0, 0.4) > cost(lying, 0, 0.03) + 1.0
