import math

import pytest

from coral.contact.scene.trial import PhysicalParameters
from coral.contact.tasks import load_task
from coral.contact.world_model.parameter_estimates import ParameterEstimates, parse_beliefs, verify_estimates
from coral.errors import InputError

SIZES = {"mug": (0.08, 0.08, 0.1)}


def answer(**objects):
    return ParameterEstimates.model_validate(
        {name: {"mass_kg": mass, "friction_coeff": friction} for name, (mass, friction) in objects.items()}
    )


def test_plausible_estimates_pass():
    assert verify_estimates(answer(mug=(0.3, 0.5)), SIZES) is None


@pytest.mark.parametrize(
    ("given", "code", "words"),
    [
        (answer(), "objects", "missing: mug"),
        (answer(mug=(0.3, 0.5), cup=(0.3, 0.5)), "objects", "not in the scene: cup"),
        (answer(mug=(-1.0, 0.5)), "bounds", "mass_kg of mug is -1"),
        (answer(mug=(0.3, 9.0)), "bounds", "between 0.02 and 2"),
        (answer(mug=(math.nan, 0.5)), "bounds", "nan"),
        (answer(mug=(15.0, 0.5)), "density", "kg/m3"),
    ],
)
def test_impossible_estimates_are_refused_with_a_reason(given, code, words):
    found = verify_estimates(given, SIZES)
    assert found.code == code
    assert words in found.reason


def test_masses_and_frictions_are_read_object_by_object():
    task = load_task("pick-clutter")
    first, second = (item.name for item in task.objects[:2])
    assert parse_beliefs(f"{first}=2,0.9; {second} = 0.2 , 0.4;", task) == {
        first: PhysicalParameters(2.0, 0.9),
        second: PhysicalParameters(0.2, 0.4),
    }


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("board", "NAME=MASS,FRICTION"),
        ("board=2", "NAME=MASS,FRICTION"),
        ("board=2,x", "NAME=MASS,FRICTION"),
        ("", "NAME=MASS,FRICTION"),
        ("bord=2,0.9", "did you mean 'board'?"),
        ("board=2,0.9;board=1,1", "twice"),
        ("board=nan,0.9", "board, mass (kg)"),
        ("board=2,7", "board, friction"),
        ("board=inf,1", "0.005 to 20"),
    ],
)
def test_what_cannot_be_believed_is_refused_in_a_line(text, said):
    with pytest.raises(InputError) as caught:
        parse_beliefs(text, load_task("push-pick-board"))
    assert said in str(caught.value)
    assert "--believe" in str(caught.value)
