from coral.contact.control.hand_plan import HandPlan


def test_a_plan_of_targets_alone_is_valid_and_costs_nothing():
    plan = HandPlan(())
    assert (plan.valid, plan.cost, plan.effective_samples) == (True, 0.0, 1.0)
    assert HandPlan((), terms={"reach": 2.0, "lift": -0.5}).cost == 1.5
