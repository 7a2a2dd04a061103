import math

import pytest

from coral.contact.world_model.parameter_estimates import ParameterEstimates, verify_estimates

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
