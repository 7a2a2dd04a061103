import numpy as np
import pytest

from coral.contact.cost.context import Context
from coral.contact.cost_program.errors import CostError
from coral.contact.plan.numpy_cost import NumpyCost

STATE = Context({"ee_pos": np.ones((2, 3, 3)), "time": np.zeros((2, 3))}, (2, 3))


def cost_of(function):
    return NumpyCost(function)(STATE)


def test_named_terms_and_a_bare_array_are_taken():
    assert cost_of(lambda state: {"high": state.ee_pos[..., 2]})["high"].shape == (2, 3)
    assert cost_of(lambda state: state.time)["cost"].shape == (2, 3)


def test_a_number_counts_for_every_state():
    assert cost_of(lambda state: {"far": 3})["far"].shape == (1, 1)


@pytest.mark.parametrize(
    ("function", "code"),
    [
        (lambda state: state.ee_pos, "shape"),
        (lambda state: np.zeros(3), "shape"),
        (lambda state: {"reach": "far"}, "wrong_return"),
        (lambda state: {"reach\ud800": 1.0}, "wrong_return"),
        (lambda state: None, "wrong_return"),
        (lambda state: state.box_pos, "raised"),
        (lambda state: 1 / 0, "raised"),
    ],
)
def test_what_is_no_cost_is_an_error_of_the_cost(function, code):
    with pytest.raises(CostError) as told:
        cost_of(function)
    assert told.value.code == code


def test_an_exception_names_the_line_of_the_function():
    def wrong(state):
        return {"reach": state.ee_poss}

    with pytest.raises(CostError) as told:
        NumpyCost(wrong)(STATE)
    assert (told.value.line, told.value.shown) == (
        wrong.__code__.co_firstlineno + 1,
        'return {"reach": state.ee_poss}',
    )
    assert "no quantity 'ee_poss'" in told.value.text
