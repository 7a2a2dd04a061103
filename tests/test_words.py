import pytest

from coral.words import many


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
