"""A trace records the distances in order."""

import numpy as np

from coral.contact.cost_program import CostProgram

SOURCE = "def state_cost(self):\n    d = norm(self.ee_pos)\n    return d + 2.0 * dist(self.ee_pos, self.box_pos)\n"


def test_a_distance_is_recorded_with_its_line_and_its_value(schema, states):
    state = states(np.random.default_rng(0))
    traced = CostProgram(SOURCE, schema).trace(state)
    assert [found.line for found in traced.distances] == [2, 3]
    first, second = (found.value for found in traced.distances)
    np.testing.assert_allclose(second, np.linalg.norm(state["ee_pos"] - state["box_pos"], axis=-1))
    np.testing.assert_allclose(sum(traced.terms.values()), first + 2.0 * second)
