import math

import pytest

from coral.exam.worth import share_left


@pytest.mark.parametrize(
    ("error", "share"), [(0.0, 1.0), (1.0, 0.75), (3.0, 0.25), (4.0, 0.0), (9.0, 0.0), (math.nan, 0.0), (math.inf, 0.0)]
)
def test_what_is_left_falls_straight_to_nothing(error, share):
    assert share_left(error, 4.0) == share
