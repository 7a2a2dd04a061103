import numpy as np
from cost_oracles import SCHEMA
from hand_rollouts import rolled_out

from coral.contact.cost.context import Context
from coral.contact.cost_program import CostProgram
from coral.contact.plan.attraction import DIRECTIONS, at_rest, cost_at, follow_cost, starting_places, total_cost


def costing(expression):
    return CostProgram(f"def state_cost(self):\n    return {expression}", SCHEMA)


def resting():
    return at_rest(rolled_out(np.random.default_rng(0)))


def test_the_hand_is_led_to_the_target_from_everywhere():
    values = resting()
    found = follow_cost(costing("2.0 * norm(self.ee_pos - self.box_pos)"), values)
    np.testing.assert_allclose(found.ends, np.broadcast_to(values["box_pos"][0, 0], found.ends.shape), atol=0.004)
    assert len(found.ends) == len(starting_places(values)) == 11
    assert found.span > 0.2


def test_equal_costs_lead_to_one_place_however_they_are_written():
    values = resting()
    squares = " + ".join(f"(self.ee_pos[{k}] - self.box_pos[{k}]) ** 2" for k in range(3))
    one = follow_cost(costing("norm(self.ee_pos - self.box_pos)"), values)
    other = follow_cost(costing(f"np.sqrt({squares})"), values)
    np.testing.assert_allclose(one.ends, other.ends, atol=1e-9)


def test_a_cost_that_does_not_depend_on_the_hand_leaves_it_where_it_is():
    values = resting()
    found = follow_cost(costing("norm(self.box_pos - self.board_pos)"), values)
    np.testing.assert_array_equal(found.ends, starting_places(values))
    assert found.span == 0.0


def test_at_rest_nothing_moves_and_nothing_is_touched():
    values = resting()
    assert all(value.shape[:2] == (1, 1) for value in values.values())
    for name in ("box_vel", "box_hand_contact", "box_left_contact", "ee_force", "last_action", "board_hand_force"):
        assert not values[name].any()
    assert values["box_table_contact"].shape == (1, 1)


def test_the_cost_is_evaluated_at_each_place_of_the_hand():
    values = resting()
    places = np.array([[0.0, 0.0, 0.1], [0.3, 0.0, 0.1]])
    np.testing.assert_allclose(cost_at(costing("self.ee_pos[0]"), values, places), [0.0, 0.3])


def test_terms_of_one_number_count_in_every_state():
    state = Context({}, (2, 3))
    np.testing.assert_array_equal(
        total_cost({"a": np.ones((1, 1)), "b": np.ones((2, 1))}, state.shape), 2 * np.ones((2, 3))
    )


def test_directions_are_unit_vectors_all_around():
    np.testing.assert_allclose(np.linalg.norm(DIRECTIONS, axis=1), 1.0)
    np.testing.assert_allclose(DIRECTIONS.sum(axis=0), 0.0, atol=1e-12)


def test_clearances_follow_the_hand_downhill(scene):
    """A cost of the clearance alone leads the hand to the box."""
    one = scene("pick-box")
    cost = CostProgram("def state_cost(self):\n    return 5.0 * self.box_hand_clearance", one.world.schema, "near")
    values = at_rest(one.world.present(one.now))
    found = follow_cost(cost, values)
    assert found.reached.max() < 0.02
    assert cost_at(cost, values, starting_places(values)).max() > 0.5
