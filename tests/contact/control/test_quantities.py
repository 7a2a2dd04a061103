"""The names that the costs of a task may read, and the values of those that stay the same."""

import numpy as np
import pytest
from contact_bench import body, make_trial, plain, seen

from coral.contact.control.quantities import constants, stage_constants, task_schema_of
from coral.contact.scene.trial import PhysicalParameters

TIN = {"name": "tin", "parts": [{"size": [0.04] * 3}], "mass_kg": 0.2, "friction": 0.5, "x": 0, "y": 0.2}
BELIEFS = [
    {"box": PhysicalParameters(0.1, 0.3), "tin": PhysicalParameters(0.2, 0.4)},
    {"box": PhysicalParameters(1.5, 0.6), "tin": PhysicalParameters(0.3, 0.5)},
]


@pytest.fixture
def trial():
    return make_trial(objects=[*plain()["objects"], TIN], table={"center": [0.1, 0.0], "size": [0.8, 0.6, 0.04]})


def test_every_constant_of_the_schema_has_a_value_of_its_size(trial):
    schema = task_schema_of(trial.task)
    found = constants(trial, seen(trial), BELIEFS, 6) | stage_constants(seen(trial))
    planned = {f"{name}_seen" for name in trial.objects}  # the planning world tells it at each plan
    assert set(found) | planned == {name for name, quantity in schema.items() if quantity.constant}
    assert {name: value.shape[2:] for name, value in found.items()} == {
        name: (schema[name].size,) if schema[name].size else () for name in found
    }


def test_each_belief_holds_for_its_share_of_the_rollouts(trial):
    found = constants(trial, seen(trial), BELIEFS, 6)
    assert found["box_mass"].tolist() == [[0.1]] * 3 + [[1.5]] * 3
    assert found["tin_friction"].tolist() == [[0.4]] * 3 + [[0.5]] * 3


def test_the_initial_pose_is_the_one_that_was_measured(trial):
    start = seen(trial, box=body((0.05, -0.1, 0.03), (0, 0, 90)))
    found = constants(trial, start, BELIEFS, 2)
    assert found["box_init_pos"][0, 0] == pytest.approx([0.05, -0.1, 0.03])
    assert np.array_equal(found["box_init_quat"][0, 0], start.objects["box"].quaternion)


def test_the_tables_corners_places_fixtures_and_numbers_are_those_of_the_task(trial):
    found = constants(trial, seen(trial), BELIEFS, 2)
    assert found["table_min"][0, 0] == pytest.approx([-0.3, -0.3, -0.04])
    assert found["table_max"][0, 0] == pytest.approx([0.5, 0.3, 0.0])
    assert found["goal_pos"][0, 0] == pytest.approx([0.1, 0.0, 0.03])
    assert found["wall_size"][0, 0] == pytest.approx([0.04, 0.4, 0.2])
    assert found["lift_height"].tolist() == [[0.12]]


def test_objects_have_contacts_with_each_other_and_with_what_does_not_move(trial):
    schema = task_schema_of(trial.task)
    contacts = {name for name in schema if name.startswith("box_") and name.endswith("_contact")}
    parts = ("hand", "palm", "left", "right", "table", "wall", "tin")
    assert contacts == {f"box_{other}_contact" for other in parts}
    assert "box_corner_pos" in schema
    assert "tin_corner_pos" not in schema
