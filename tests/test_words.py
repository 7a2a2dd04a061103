import pytest

from coral.words import clock, is_numeral, many


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        (many(1, "plan"), "1 plan"),
        (many(2, "plan"), "2 plans"),
        (many(0, "plan"), "0 plans"),
        (many(1, "entry", "entries"), "1 entry"),
        (many(3, "entry", "entries"), "3 entries"),
    ],
)
def test_only_one_is_singular(said, expected):
    assert said == expected


@pytest.mark.parametrize(("text", "expected"), [("10", True), ("-0.5e3", True), ("1 s", False), ("", False)])
def test_a_numeral_is_what_python_reads_as_a_number(text, expected):
    assert is_numeral(text) is expected


@pytest.mark.parametrize(
    ("seconds", "said"), [(0.0, "0:00"), (59.4, "0:59"), (70.6, "1:11"), (60.0, "1:00"), (3725.0, "62:05")]
)
def test_time_in_minutes_and_seconds(seconds, said):
    assert clock(seconds) == said
