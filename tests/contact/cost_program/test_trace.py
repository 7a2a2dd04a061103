"""A trace records the distances in order, and answers one of them with 0."""

import numpy as np

from coral.contact.cost_program import CostProgram
from coral.contact.cost_program.trace import Trace

SOURCE = "def state_cost(self):\n    d = norm(self.ee_pos)\n    return d + 2.0 * dist(self.ee_pos, self.box_pos)\n"


def test_a_distance_is_recorded_with_its_line_and_its_components():
    trace = Trace()
    assert trace.distance(7, (np.array([[3.0, 0.0]]), 4.0), 5.0) == 5.0
    (found,) = trace.distances
    assert found.line == 7
    assert [part.tolist() for part in found.vector] == [[[3.0, 0.0]], [[4.0]]]
    assert found.value.tolist() == [[5.0]]


def test_only_the_distance_of_the_given_number_is_answered_with_zero():
    trace = Trace(zeroed=1)
    assert [trace.distance(1, (), value) for value in (5.0, 6.0, 7.0)] == [5.0, 0.0, 7.0]
    assert [found.value.item() for found in trace.distances] == [5.0, 6.0, 7.0]


def test_a_program_goes_on_with_the_distance_that_is_answered(schema, states):
    state = states(np.random.default_rng(0))
    program = CostProgram(SOURCE, schema)
    plain, zeroed = program.trace(state), program.trace(state, zeroed=1)
    assert [found.line for found in plain.distances] == [2, 3]
    np.testing.assert_allclose(sum(zeroed.terms.values()), np.linalg.norm(state["ee_pos"], axis=-1))
    np.testing.assert_allclose(plain.distances[1].value, np.linalg.norm(state["ee_pos"] - state["box_pos"], axis=-1))
