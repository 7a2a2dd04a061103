"""What `self` answers: quantities of the schema, and their names in the paper's environment."""

import numpy as np
import pytest

from coral.contact.cost.context import Context, Quantity
from coral.contact.cost_program import CostError, LimitsCfg
from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.sharing import memory
from coral.contact.cost_program.state import StateSpace, objects_of


@pytest.fixture
def space(schema):
    return StateSpace(schema)


@pytest.fixture
def batch(states):
    return Meter(states(np.random.default_rng(0)), LimitsCfg())


def test_objects_are_what_has_a_pose_other_than_the_hand(schema, space):
    assert objects_of(schema) == ["board", "box"]
    assert space.fixtures == ["table", "wall"]


def test_a_quantity_is_read_component_by_component(space, batch):
    found = space.read(batch, "box_pos")
    assert np.array_equal(np.stack(found.items, axis=-1), batch.context["box_pos"])
    assert space.read(batch, "box_hand_contact").dtype == np.bool_


def test_a_name_with_ori_is_the_quaternion_with_its_scalar_last(space, batch):
    quat, ori = space.read(batch, "box_quat"), space.read(batch, "box_ori")
    assert ori.items == (*quat.items[1:], quat.items[0])
    assert (quat.order, ori.order) == ("wxyz", "xyzw")
    assert space.quantities("box_ori") == ["box_quat"]


def test_reading_a_quantity_twice_gives_the_same_memory(space, batch):
    assert memory(space.read(batch, "box_pos")) == memory(space.read(batch, "box_pos"))
    assert not memory(space.read(batch, "box_pos")) & memory(space.read(batch, "board_pos"))


def test_contact_is_contact_of_the_hand_with_any_object(space, batch):
    state = batch.context
    wanted = (state["box_hand_contact"] != 0) | (state["board_hand_contact"] != 0)
    assert np.array_equal(space.read(batch, "in_contact"), wanted)


@pytest.mark.parametrize(
    ("name", "body"), [("panda", "hand"), ("robot_id", "hand"), ("box", "box"), ("tableId", "table")]
)
def test_bodies_have_the_names_of_the_paper(name, body, space, batch):
    assert space.read(batch, name).name == body


def test_handles_of_the_simulator_are_known_and_nothing_else(space, batch):
    assert space.read(batch, "cid").name == "other"
    assert space.has("ee_link")
    assert not space.has("sphere")
    with pytest.raises(CostError, match=r"did you mean 'box_pos'\?") as caught:
        space.read(batch, "bx_pos")
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
    meter = Meter(Context(values, (4, 5)), LimitsCfg())
    with pytest.raises(CostError, match=words) as caught:
        StateSpace({"x": Quantity(3, "m", "")}).read(meter, "x")
    assert caught.value.code == "missing_state"
