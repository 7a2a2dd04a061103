from coral.contact.cost.stages import Stage, Strategy
from coral.contact.cost_program import CostError
from coral.contact.scene.trial import prior_beliefs, stated_beliefs
from coral.contact.thinker.strategist import FixedStrategist, StrategistCounts

STRATEGY = Strategy("expert", (Stage("reach", lambda state: {}),))


def test_a_fixed_strategist_plans_with_what_the_author_of_its_strategy_believes(scene):
    one = scene("pick-clutter")
    one.world.believe(prior_beliefs(one.trial))
    assert FixedStrategist(STRATEGY).begin(one.trial, one.now, one.world) is STRATEGY
    assert one.world.beliefs[0] == stated_beliefs(one.trial) != prior_beliefs(one.trial)


def test_a_fixed_strategist_keeps_its_strategy_whatever_happens(scene):
    one, fixed = scene("pick-box"), FixedStrategist(STRATEGY)
    fixed.begin(one.trial, one.now, one.world)
    assert fixed.on_plan(None) is None
    assert fixed.on_cost_error(CostError("not_finite", "no"), "reach", one.now) is None
    assert fixed.guess_poses(one.trial, one.now) == {}
    assert fixed.counts == StrategistCounts(advisor_calls=0, repairs=0, memory_hit=False)
