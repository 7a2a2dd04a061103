"""A program over a batch gives what Python gives state by state."""

import textwrap

import numpy as np
import pytest

from coral.contact.cost.context import Context
from coral.contact.cost_program import CostError, CostProgram


def test_the_board_example_agrees_with_numpy(board, schema, states, plainly):
    state = states(np.random.default_rng(2), 3, 4)
    np.testing.assert_allclose(
        sum(CostProgram(board, schema).evaluate(state).values()), plainly(board, state), rtol=1e-9
    )


def test_a_batch_of_states_equals_its_single_states(board, schema, states):
    state = states(np.random.default_rng(4), 3, 4)
    program = CostProgram(board, schema)
    whole = program(state)
    for i in range(3):
        one = Context(
            {n: state[n][i : i + 1, 1:2] if state[n].shape[:2] != (1, 1) else state[n] for n in state.names()}, (1, 1)
        )
        for name, term in program(one).items():
            assert term[0, 0] == whole[name][i, 1]


@pytest.mark.parametrize(
    "body", ["v = self.ee_pos\n    v *= 0.0\n    return v[0]", "self.box_pos[0] = 1.0\n    return 1.0"]
)
def test_a_program_cannot_change_the_state(body, schema, states):
    with pytest.raises(CostError, match=r"write v = v|make a new one"):
        CostProgram(f"def state_cost(self):\n    {body}", schema)(states(np.random.default_rng(0)))


def test_named_terms_come_as_returned(schema, states):
    state = states(np.random.default_rng(6))
    terms = CostProgram(
        'def state_cost(self):\n    return {"reach": norm(self.ee_pos), "time": 0.1 * self.time}', schema
    )(state)
    assert list(terms) == ["reach", "time"]
    assert np.array_equal(terms["time"], 0.1 * state["time"])


def test_terms_filled_without_a_return_are_the_cost(schema, states):
    source = 'def state_cost(self):\n    terms["reach"] = norm(self.ee_pos)\n    terms["time"] = self.time'
    program = CostProgram(source, schema)
    assert list(program(states(np.random.default_rng(7)))) == ["reach", "time"]


def test_a_term_of_one_branch_is_zero_in_the_other(schema, states):
    state = states(np.random.default_rng(8))
    source = textwrap.dedent("""
        def state_cost(self):
            terms = {"time": self.time}
            if self.board_hand_contact:
                terms["touch"] = -5.0
            return terms
    """)
    terms = CostProgram(source, schema)(state)
    assert np.array_equal(terms["touch"], np.where(state["board_hand_contact"] != 0, -5.0, 0.0))


def test_a_cost_that_is_a_number_is_one_term(schema, states):
    state = states(np.random.default_rng(8))
    terms = CostProgram("def state_cost(self):\n    return 1.0 + self.time", schema)(state)
    assert list(terms) == ["cost"]
    assert np.array_equal(terms["cost"], 1.0 + state["time"])


def test_only_what_is_read_is_asked_for(schema):
    source = "def state_cost(self):\n    return norm(self.ee_pos) + self.box_vel[2] + self.nothing"
    assert CostProgram(source, schema).reads == ["box_vel", "ee_pos"]


@pytest.mark.parametrize(
    ("body", "code", "line", "words"),
    [
        ("return self.bord_pos[0]", "unknown_state", 2, "did you mean 'board_pos'?"),
        ("return nrom(self.ee_pos)", "unknown_name", 2, "did you mean 'norm'?"),
        ("return board_pos[0]", "unknown_name", 2, "did you mean self.board_pos?"),
        ("return np.linalg.det(self.ee_pos)", "unknown_attribute", 2, "it has norm"),
        ("return p.getJointState(self.panda, 3)[0]", "unknown_name", 2, "self.NAME_pos"),
        ("return self.ee_pos", "wrong_return", 0, "a vector of 3"),
        ("return self.ee_pos[self.current_step]", "not_fixed", 2, "constant"),
        ("return self.ee_pos[3]", "wrong_size", 2, "no entry 3"),
        ("return norm(self.ee_pos - self.ee_quat)", "wrong_size", 2, "a vector of 3 and a vector of 4"),
        ("cost = 1.0", "no_return", 0, "without a return"),
        ("if self.time > 0.5:\n        return 1.0", "no_return", 0, "ends"),
        ("if self.time > 0.5:\n        d = 1.0\n    return d", "unset", 4, "some states only"),
        ("x = None if self.time > 0.5 else 1.0\n    return x", "mixed", 2, "None"),
        ("return 1.0 / (self.time * 0.0)", "not_finite", 2, "guard divisions"),
        ("return math.acos(2.0 + self.time)", "not_finite", 2, "math.acos"),
        ("break", "syntax", 2, "outside a loop"),
        ("a = self.ee_pos\n    b = a\n    b[0] = 1.0\n    return a[0]", "not_allowed", 4, "make a new one"),
        ("return np.clip(self.time, 0.0, 1.0)[1]", "wrong_type", 2, "no numbered entries"),
        ("return dist(self.ee_pos)", "wrong_call", 2, "missing a required argument: 'q'"),
        ("if self.ee_pos:\n        return 1.0\n    return 0.0", "wrong_type", 2, "neither true nor false"),
        ("cost += self.time\n    return cost", "unset", 2, "begin with"),
    ],
)
def test_an_error_names_the_line_and_what_there_is(body, code, line, words, schema, states):
    source = f"def state_cost(self):\n    {body}\n"
    with pytest.raises(CostError) as caught:
        CostProgram(source, schema)(states(np.random.default_rng(9)))
    assert caught.value.code == code
    assert caught.value.line == line or code == "no_return"
    assert words in str(caught.value) or code == "no_return"


def test_an_unknown_quantity_is_answered_with_all_there_are(schema, states):
    with pytest.raises(CostError, match=r"ee_force, ee_pos, ee_quat"):
        CostProgram("def state_cost(self):\n    return self.gripper_width", schema)(states(np.random.default_rng(10)))
