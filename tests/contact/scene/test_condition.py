"""What conditions share: contacts by name, forces, names that must exist."""

import numpy as np
import pytest
from contact_bench import body, plain, touch, truth, written

from coral.contact.scene.condition import StepClock, degrees_between, hand_force, touches
from coral.contact.scene.observation import HandForce, Truth
from coral.errors import InputError


@pytest.mark.parametrize(
    ("thing", "found"), [("hand", True), ("left", True), ("right", False), ("table", False), ("robot", False)]
)
def test_the_hand_stands_for_its_parts(thing, found):
    assert touches(truth(0, None, touch("box", "left"), touch("table", "wall")), "box", thing) is found


def test_a_force_measured_over_the_step_counts_before_the_contacts_at_its_end():
    contacts = (touch("hand", "box", (9, 0, 0)),)
    assert hand_force(truth(0, None, *contacts), "box") == pytest.approx(9)
    measured = {"box": HandForce(np.array([3.0, 4.0, 0.0]), 8.0)}
    assert hand_force(Truth(0, body(), 0.08, {"box": body()}, contacts, measured), "box") == pytest.approx(5)
    never = {"box": HandForce(None, 0.0)}
    assert hand_force(Truth(0, body(), 0.08, {"box": body()}, contacts, never), "box") is None
    assert hand_force(truth(0), "box") is None


def test_the_clock_does_not_count_the_time_before_its_first_call():
    clock = StepClock()
    assert [clock.advance(truth(t)) for t in (5.0, 5.5, 5.6)] == pytest.approx([0.0, 0.5, 0.1])


def test_an_angle_is_between_directions():
    assert degrees_between(np.array([1.0, 0, 0]), np.array([0, -1.0, 0])) == pytest.approx(90)


@pytest.mark.parametrize(
    ("condition", "field"),
    [
        ({"kind": "touching", "thing": "hind"}, "thing"),
        ({"kind": "never-touched", "thing": "rabot"}, "thing"),
        ({"kind": "grasped", "point": "cornr"}, "point"),
        ({"kind": "slid", "thing": "hand", "distance_m": 0.1}, "thing"),
    ],
)
def test_names_must_exist(tmp_path, condition, field):
    with pytest.raises(InputError) as caught:
        written(tmp_path, plain() | {"success": {"conditions": [condition | {"object": "box"}]}})
    assert caught.value.field == f"success.conditions[0].{field}"
