import dataclasses

import numpy as np
import pytest
from recorded import compose

from coral.contact.plan.cost_plan import PlanAnswer, make_strategy
from coral.contact.plan.sampled_states import best_gain
from coral.contact.scene.task_file import shipped_tasks

CLOSER = "def state_cost(self):\n    return norm(self.ee_pos - self.box_pos)"
FOREVER = "def state_cost(self):\n    return 100.0 + norm(self.box_pos - np.array([0.0, 0.0, 5.0]))"


def first_stage(one, plan, regions=None):
    return make_strategy("x", plan, regions, one.world.schema, one.sizes).stages[0]


def gained(one, stage, seed=0):
    return best_gain(one.world, stage, one.now, one.sizes, np.random.default_rng(seed))


@pytest.mark.parametrize("task", ["pick-box", "push-force", "flip-wall"])
def test_without_guides_what_can_work_gains_by_ways_of_its_own(scene, task):
    one = scene(task)
    assert gained(one, first_stage(one, compose(one.facts).plan)) > 0.1


def test_without_guides_what_no_way_lowers_gains_nothing(scene):
    one = scene("pick-box")
    assert gained(one, first_stage(one, PlanAnswer(code=CLOSER))) > 0.3
    assert gained(one, first_stage(one, PlanAnswer(code=FOREVER))) < 0.02


def test_without_guides_the_same_seed_gains_the_same(scene):
    stage = first_stage(one := scene("pick-clutter"), compose(one.facts).plan)
    assert gained(one, stage, 3) == gained(one, stage, 3)


@pytest.mark.parametrize("task", shipped_tasks())
def test_a_recorded_plan_gains_by_its_own_guides(scene, task):
    made = compose((one := scene(task)).facts)
    assert gained(one, first_stage(one, made.plan, made.regions)) > 0.3


def test_guides_alone_give_the_ways_where_there_are_any(scene):
    one = scene("pick-box")
    made = compose(one.facts)
    stage = first_stage(one, made.plan, made.regions)
    rng = np.random.default_rng(0)
    found = best_gain(one.world, stage, one.now, one.sizes, rng)
    assert rng.random() == np.random.default_rng(0).random()
    assert found == gained(one, stage, 1)
    assert found != gained(one, dataclasses.replace(stage, guides=()))
