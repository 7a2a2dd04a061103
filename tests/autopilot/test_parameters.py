"""Parameters: known names are set, others refused."""

import math

import pytest

from autopilot.parameters import DEFAULTS, ParameterStore


def test_known_parameters_are_set():
    store = ParameterStore({"FS_LEAK_ENABLE": 2.0})
    assert store["FS_LEAK_ENABLE"] == 2.0
    assert store.write("BATT_LOW_VOLT", 12.0)
    assert store["BATT_LOW_VOLT"] == 12.0
    assert DEFAULTS["FS_LEAK_ENABLE"] == 1.0


@pytest.mark.parametrize(("name", "value"), [("NO_SUCH", 1.0), ("BATT_LOW_VOLT", math.nan)])
def test_unknown_names_and_odd_numbers_are_refused(name, value):
    store = ParameterStore()
    assert not store.write(name, value)
    assert store.values == DEFAULTS
