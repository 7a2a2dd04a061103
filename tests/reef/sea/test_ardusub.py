"""Versions and flags as ArduSub sends them."""

import math
import sys

import pytest

from coral.errors import InputError
from coral.reef.sea import ardusub


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (67567616, "ArduSub 4.7.0-dev (507e6101)"),
        (0x040105FF, "ArduSub 4.1.5 (507e6101)"),
        (0x040500C0, "ArduSub 4.5.0-rc (507e6101)"),
        (0x04050080, "ArduSub 4.5.0-beta (507e6101)"),
    ],
)
def test_a_version_is_shown_as_the_project_writes_it(number, text):
    assert ardusub.version_text(number, b"507e6101") == text


@pytest.mark.parametrize(
    ("number", "says"),
    [(0x040003FF, "older than 4.1"), (0x040105FF, ""), (67567616, ""), (0x04080000, "newer than 4.7")],
)
def test_versions_that_the_driver_does_not_know_are_told(number, says):
    assert says in ardusub.version_warning(number)
    assert bool(says) == bool(ardusub.version_warning(number))


@pytest.mark.parametrize(
    ("flags", "position"),
    [(831, True), (167, False), (37, False), (0, False), (1024, False), (8, True), (16 | 128, False)],
)
def test_the_estimators_flags(flags, position):
    assert ardusub.has_position(flags) is position


def test_without_pymavlink_one_line_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "pymavlink.dialects.v20.ardupilotmega", None)
    with pytest.raises(InputError, match=r"the extra vehicle: "):
        ardusub.load_dialect()


@pytest.mark.parametrize(
    ("depth", "rate"), [(0.0, 0.25), (1.9, 0.08), (2.0, 0.0), (2.1, -0.08), (9.0, -0.25), (None, 0.0), (math.nan, 0.0)]
)
def test_climb_rate_goes_to_the_depth_within_its_limit(depth, rate):
    assert ardusub.climb_rate(depth, 2.0) == pytest.approx(rate)


def test_a_wanted_depth_that_is_no_number_changes_nothing():
    assert ardusub.climb_rate(1.0, math.nan) == 0.0
