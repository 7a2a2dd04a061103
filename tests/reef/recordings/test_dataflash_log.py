"""Records of a dataflash log."""

import math

import pytest
from autopilot_logs import dataflash, dataflash_dive

from coral.reef.recordings.dataflash_log import read_dataflash


def kinds(content):
    found = {}
    for kind, t, values in read_dataflash(content):
        found.setdefault(kind, []).append((t, values))
    return found


def test_positions_of_the_estimator_in_charge_and_attitudes():
    found = kinds(
        dataflash(
            ("XKF1", 1.0, 0, 5.0, 7.0), ("XKF1", 1.0, 1, 9.0, 9.0), ("XKF4", 1.0, 0, 831, 1), ("XKF4", 1.0, 1, 167, 1),
            ("XKF1", 1.1, 0, 5.0, 7.0), ("XKF1", 1.1, 1, 9.0, 9.5), ("ATT", 1.2, 100, -200, 27000),
        )
    )  # fmt: skip
    assert found["position"] == [(1.0, (7.0, 5.0)), (pytest.approx(1.1), (9.5, 9.0))]
    assert found["standing"] == [(1.0, (1.0,))]
    assert found["attitude"][0][1] == pytest.approx(tuple(map(math.radians, (1.0, -2.0, 270.0))))


def test_places_ranges_and_the_time_of_the_satellites():
    found = kinds(
        dataflash(
            ("POS", 1.0, 0, 0), ("POS", 1.1, 483861421, -1246305728), ("GPS", 1.2, 1, 0, 0, 0, 0),
            ("GPS", 2.0, 3, 320_000, 2260, 483861421, -1246305728), ("RFND", 1.0, 150, 4, 25), ("RFND", 1.1, 150, 4, 0),
            ("RFND", 1.2, 150, 2, 25),
        )
    )  # fmt: skip
    assert found["place"] == [(pytest.approx(1.1), pytest.approx((-124.6305728, 48.3861421)))]
    # 2023-04-30 00:05:02 UTC: the week's beginning, 320 s, less 18 leap seconds.
    assert found["clock"][0][1][0] + 2.0 == 1_682_813_102.0
    assert found["range"] == [(1.0, (1.5,))]


def test_damaged_bytes_are_passed_over_and_counted():
    whole = dataflash(("XKF1", 1.0, 0, 5.0, 7.0), ("XKF1", 2.0, 0, 6.0, 7.0))
    found = kinds(whole[:-20] + b"\xa3\x95\x05rubbish" + whole[-20:] + whole[-20:-3])
    assert len(found["position"]) == 2
    assert sum(values[0] for _, values in found["unread"]) == 10 + 17


@pytest.mark.parametrize(
    ("old", "new"), [(b"QBff", b"QBf\0"), (b"PN,PE", b"PN,Up"), (b"QBff", b"QBnf"), (b"PN,PE", b"PN;PE")]
)
def test_a_format_that_contradicts_its_size_or_lacks_a_column_is_not_read(old, new):
    whole = dataflash_dive()
    assert "position" in kinds(whole)
    found = kinds(whole.replace(old, new))
    assert "position" not in found
    assert len(found["attitude"]) == 41
