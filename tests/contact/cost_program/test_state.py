"""What `self` answers: the quantities of the schema."""

import numpy as np
import pytest

from coral.contact.cost.context import Context, Quantity
from coral.contact.cost_program import CostError
from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.state import objects_of, read_quantity


@pytest.fixture
def batch(states):
    return Meter(states(np.random.default_rng(0)))


def test_objects_are_what_has_a_pose_other_than_the_hand(schema):
    assert objects_of(schema) == ["board", "box"]


def test_a_quantity_is_read_component_by_component(schema, batch):
    found = read_quantity(batch, schema, "box_pos")
    assert np.array_equal(np.moveaxis(found, 0, -1), batch.context["box_pos"])
    assert read_quantity(batch, schema, "box_hand_contact").dtype == np.bool_


def test_a_name_that_the_state_does_not_have_is_refused_with_a_like_one(schema, batch):
    with pytest.raises(CostError, match=r"did you mean 'box_pos'\?") as caught:
        read_quantity(batch, schema, "bx_pos")
    assert caught.value.code == "unknown_state"


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({}, "the batch lacks x"),
        ({"x": np.zeros((4, 5))}, r"x has shape \(4, 5\)"),
        ({"x": np.zeros((4, 5, 2))}, r"x has shape \(4, 5, 2\)"),
        ({"x": np.zeros((3, 5, 3))}, r"in a batch of \(4, 5\)"),
    ],
)
def test_a_batch_that_breaks_its_schema_is_refused(values, words):
    meter = Meter(Context(values, (4, 5)))
    with pytest.raises(CostError, match=words) as caught:
        read_quantity(meter, {"x": Quantity(3, "m", "")}, "x")
    assert caught.value.code == "missing_state"
