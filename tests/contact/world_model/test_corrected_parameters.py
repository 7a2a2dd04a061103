import math

import pytest
from pydantic import ValidationError

from coral.contact.scene.trial import PhysicalParameters
from coral.contact.world_model.corrected_parameters import ObjectParameters, ParametersAnswer, verify_parameters

BELIEVED = {"box": PhysicalParameters(1.0, 0.5), "cup": PhysicalParameters(0.2, 0.4)}


def answer(*objects):
    return ParametersAnswer(
        objects=[ObjectParameters(label=label, mass=mass, friction=friction) for label, mass, friction in objects]
    )


def test_a_correction_within_the_bounds_may_be_tried():
    assert verify_parameters(answer(("box", 0.4, 0.3)), BELIEVED) is None
    assert verify_parameters(answer(("box", 0.005, 2.0), ("cup", 20.0, 0.02)), BELIEVED) is None


@pytest.mark.parametrize(
    ("given", "code", "reason"),
    [
        (("mug", 0.4, 0.3), "objects", "mug is no object; there are box, cup"),
        (("box", 20.5, 0.3), "bounds", "mass of box is 20.5; it lies within 0.005 and 20"),
        (("box", 0.0, 0.3), "bounds", "mass of box is 0; it lies within 0.005 and 20"),
        (("box", 0.4, 2.5), "bounds", "friction of box is 2.5; it lies within 0.02 and 2"),
        (("box", 0.4, -0.1), "bounds", "friction of box is -0.1"),
        (("box", math.nan, 0.3), "bounds", "mass of box is nan"),
        (("box", 0.4, math.inf), "bounds", "friction of box is inf"),
    ],
)
def test_an_impossible_correction_is_refused_with_a_reason(given, code, reason):
    found = verify_parameters(answer(("cup", 0.2, 0.4), given), BELIEVED)
    assert found.code == code
    assert found.reason.startswith(reason)


def test_a_correction_of_one_object_leaves_the_others_as_they_were_believed():
    assert answer(("box", 0.4, 0.3)).physical(BELIEVED) == {
        "box": PhysicalParameters(mass_kg=0.4, friction=0.3),
        "cup": BELIEVED["cup"],
    }
    assert BELIEVED["box"] == PhysicalParameters(1.0, 0.5)


def test_two_entries_for_one_object_are_no_answer():
    with pytest.raises(ValidationError, match="two entries for box"):
        answer(("box", 0.4, 0.3), ("cup", 0.2, 0.4), ("box", 0.5, 0.3))


def test_values_are_kept_if_they_are_those_that_a_prompt_shows():
    assert answer(("box", 1.0, 0.5)).keeps(BELIEVED)
    assert answer(("box", 1.004, 0.501), ("cup", 0.2, 0.4)).keeps(BELIEVED)
    assert not answer(("box", 1.05, 0.5)).keeps(BELIEVED)
    assert not answer(("mug", 1.0, 0.5)).keeps(BELIEVED)


def test_an_answer_corrects_at_least_one_object_and_at_most_eight():
    for objects in ([], [("box", 0.4, 0.3)] * 9):
        with pytest.raises(ValidationError, match="objects"):
            answer(*objects)
