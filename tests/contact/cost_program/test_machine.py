"""Names are found as in Python, and branches that only some states take are joined again."""

import numpy as np
import pytest

from coral.contact.cost_program import CostError
from coral.contact.cost_program.machine import Machine, filled, merge, merge_variables
from coral.contact.cost_program.statements import run_block
from coral.contact.cost_program.values import Module, Partial, Poison, Scope

FIRST, SECOND = np.array([[True, False]]), np.array([[False, True]])


@pytest.fixture
def machine(meter, schema):
    outer = Scope(None, frozenset({"weight", "later"}), variables={"weight": 2.0})
    inner = Scope(outer, frozenset({"gap"}), variables={"gap": 1.0})
    return Machine(meter, schema, {}, run_block, [outer, inner])


def test_a_name_is_looked_up_from_the_inside_out(machine):
    assert machine.lookup("gap") == 1.0
    assert machine.lookup("weight") == 2.0
    assert machine.lookup("norm").name == "norm"
    assert isinstance(machine.lookup("numpy"), Module)
    assert machine.lookup("numpy").name == "np"


@pytest.mark.parametrize(
    ("name", "code", "words"),
    [
        ("later", "unset", "read before it is set"),
        ("box_pos", "unknown_name", r"did you mean self\.box_pos\?"),
        ("nrom", "unknown_name", "did you mean 'norm'"),
    ],
)
def test_a_name_without_a_value_is_refused(name, code, words, machine):
    with pytest.raises(CostError, match=words) as caught:
        machine.lookup(name)
    assert caught.value.code == code


def test_a_value_of_some_states_is_read_only_where_it_is_set(machine):
    value = Partial(3.0, FIRST)
    machine.meter.mask = FIRST
    assert machine.usable(value, "x") == 3.0
    for mask in (None, SECOND):
        machine.meter.mask = mask
        with pytest.raises(CostError, match="before the `if`"):
            machine.usable(value, "x")


def test_a_value_of_two_kinds_is_never_read(machine):
    with pytest.raises(CostError, match="'x' cannot be used: it is a text in some states"):
        machine.usable(Poison("it is a text in some states"), "x")


def test_a_joined_branch_counts_only_in_its_states(machine):
    machine.frame.variables["gap"] = 10.0
    branch = machine.snapshot()
    machine.frame.variables["gap"] = 20.0
    machine.join(FIRST, branch)
    assert machine.lookup("gap").tolist() == [[10.0, 20.0]]


def test_a_snapshot_does_not_follow_later_changes(machine):
    before = machine.snapshot()
    machine.frame.variables["gap"] = 20.0
    machine.restore(before)
    assert machine.lookup("gap") == 1.0


def test_numbers_are_taken_from_the_side_of_each_state(meter):
    assert merge(meter, FIRST, 1.0, 2.0).tolist() == [[1.0, 2.0]]


def test_a_constant_that_both_sides_agree_on_stays_a_constant(meter):
    assert merge(meter, FIRST, 3, 3) == 3
    assert merge(meter, FIRST, "a", "a") == "a"
    assert isinstance(merge(meter, FIRST, 3, 3.0), np.ndarray)


def test_one_value_of_both_sides_stays_itself(meter):
    vector = np.ones((2, 1, 1))
    assert merge(meter, FIRST, vector, vector) is vector


def test_vectors_are_joined_entry_by_entry(meter):
    found = merge(meter, FIRST, np.array([[[1.0]], [[2.0]]]), np.array([[[3.0]], [[4.0]]]))
    assert found.tolist() == [[[1.0, 3.0]], [[2.0, 4.0]]]


@pytest.mark.parametrize(("a", "b"), [(1.0, None), ("a", "b"), ([1.0], [1.0, 2.0]), ([], ())])
def test_what_cannot_be_joined_becomes_a_value_that_cannot_be_read(a, b, meter):
    assert isinstance(merge(meter, FIRST, a, b), Poison)


def test_a_variable_of_one_branch_is_set_in_its_states_only(meter):
    found = merge_variables(meter, FIRST, {"x": 1.0, "only": 5.0}, {"x": 2.0, "other": 6.0})
    assert list(found) == ["x", "only", "other"]
    assert found["only"].mask.tolist() == [[True, False]]
    assert found["other"].mask.tolist() == [[False, True]]


def test_a_key_of_one_branch_is_filled_in_the_other_states(meter):
    found = merge(meter, FIRST, {"touch": 4.0}, {})
    assert filled(meter, found["touch"], 0.0).tolist() == [[4.0, 0.0]]
    assert filled(meter, 7.0, 0.0) == 7.0


def test_a_value_set_in_both_branches_is_set_where_either_was(meter):
    found = merge(meter, FIRST, Partial(1.0, np.array([[True, True]])), Partial(2.0, np.array([[True, False]])))
    assert found.mask.tolist() == [[True, False]]
    assert found.value.tolist() == [[1.0, 2.0]]
    assert isinstance(merge(meter, FIRST, Partial(1.0, FIRST), "a"), Poison)
    whole = merge(meter, FIRST, 1.0, Partial(2.0, np.array([[False, True]])))
    assert whole.mask.tolist() == [[True, True]]
