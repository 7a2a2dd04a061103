"""Names are found as in Python, and branches that only some states take are joined again."""

import numpy as np
import pytest

from coral.contact.cost_program import CostError
from coral.contact.cost_program.machine import Machine
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
