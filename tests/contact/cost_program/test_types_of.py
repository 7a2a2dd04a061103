"""isinstance answers where Python's answer is certain, and is refused where it is not."""

import numpy as np
import pytest

from coral.contact.cost_program import CostError
from coral.contact.cost_program.library import BUILTINS, MODULES
from coral.contact.cost_program.types_of import is_instance
from coral.contact.cost_program.values import DictValue, Seq, Vec


def named(*names):
    types = [MODULES["np"][name.removeprefix("np.")] if name.startswith("np.") else BUILTINS[name] for name in names]
    return types[0] if len(types) == 1 else Seq(tuple(types), "tuple")


@pytest.mark.parametrize(
    ("value", "types", "wanted"),
    [
        (np.array([[1.0]]), ["float"], True),
        (np.array([[1.0]]), ["list", "np.floating"], True),
        (np.array([[1.0]]), ["np.ndarray"], False),
        (True, ["int"], True),
        (2, ["float"], False),
        (2, ["int", "float"], True),
        ("a", ["str"], True),
        (None, ["float", "dict"], False),
        (Vec((1.0,)), ["np.ndarray"], True),
        (Seq((1.0,)), ["list"], True),
        (Seq((1.0,), "tuple"), ["list"], False),
        (DictValue({}), ["dict"], True),
    ],
)
def test_the_type_of_a_value_is_that_of_python(value, types, wanted, meter):
    assert is_instance(meter, value, named(*types)) is wanted


@pytest.mark.parametrize(
    ("value", "types"),
    [(np.array([[True]]), ["bool"]), (np.array([[1.0]]), ["int"]), (2.0, ["np.float64"]), (2.0, ["int"])],
)
def test_a_type_that_depends_on_how_the_value_is_stored_is_refused(value, types, meter):
    with pytest.raises(CostError, match="leave this out") as caught:
        is_instance(meter, value, named(*types))
    assert caught.value.code == "wrong_type"


def test_what_is_no_type_is_refused(meter):
    for other in (3.0, BUILTINS["norm"], named("float", "abs")):
        with pytest.raises(CostError, match="isinstance takes float, int") as caught:
            is_instance(meter, 1.0, other)
        assert caught.value.code == "wrong_call"


def test_programs_decide_by_isinstance_as_in_python(agrees):
    agrees("""
        x = self.ee_pos
        s = 1.0 if isinstance(x, np.ndarray) else 2.0
        s += 10.0 * isinstance(self.time, (int, float))
        s += 100.0 * isinstance([1], list) + 1000.0 * isinstance('a', str) + isinstance(None, dict)
        return s
    """)


def test_a_truth_value_of_the_state_has_no_certain_type(refusal):
    assert "leave this out" in refusal("return 1.0 if isinstance(self.box_hand_contact, bool) else 0.0").text
