"""Water by name: published coefficients, and the waters of the presets."""

from itertools import pairwise

import pytest

from coral.errors import InputError
from coral.reef.mission.presets import PRESETS
from coral.reef.world.water_types import ALIASES, JERLOV, find_water, water_of_visibility


def test_a_water_is_found_by_its_name_its_short_name_and_by_a_preset():
    assert find_water("jerlov-3C") is find_water("3c") is find_water("bay") is JERLOV["jerlov-3C"]


def test_an_unknown_water_is_answered_with_the_nearest_name():
    with pytest.raises(InputError, match="did you mean 'jerlov-3C'"):
        find_water("jerlov-3")


def test_every_preset_has_a_water_whose_visibility_agrees_within_a_tenth():
    assert set(ALIASES) == set(PRESETS)
    for name, preset in PRESETS.items():
        visibility = preset.values.get("simulator.noise.visibility_m")
        water = find_water(name)
        if visibility is None:
            assert water.visibility_m > 12.0
        else:
            assert water.visibility_m == pytest.approx(visibility, rel=0.1)
        assert water_of_visibility(visibility) is water


def test_beam_attenuation_is_absorption_and_scattering():
    water = JERLOV["jerlov-III"]
    assert water.beam == pytest.approx((1.047, 1.054, 1.444))
    assert water.lost == pytest.approx((0.310 + 0.3685, 0.056 + 0.499, 0.031 + 0.7065))
    assert water.visibility_m == pytest.approx(4.8 / 1.054)


def test_coasts_are_the_more_turbid_the_higher_their_number():
    coastal = [JERLOV[f"jerlov-{n}C"] for n in (1, 3, 5, 7, 9)]
    assert all(a.visibility_m > b.visibility_m for a, b in pairwise(coastal))


def test_oceans_are_blue_and_coasts_are_green():
    """The colour that daylight keeps longest."""
    assert min(range(3), key=lambda k: JERLOV["jerlov-I"].diffuse[k]) == 2
    assert min(range(3), key=lambda k: JERLOV["jerlov-3C"].diffuse[k]) == 1
