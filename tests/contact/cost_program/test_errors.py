"""The error of a cost names its line, and holds nothing that a terminal could not show."""

import pytest

from coral.contact.cost_program.errors import LONGEST_NAME, CostError, is_term_name, printable


def test_an_error_shows_its_line_only_where_a_line_is_to_blame():
    assert str(CostError("unset", "no value", 3, "return x")) == "line 3 (`return x`): no value"
    assert str(CostError("unset", "no value", 3)) == "line 3: no value"
    assert str(CostError("empty", "no code")) == "no code"


def test_control_characters_and_lone_surrogates_are_escaped_and_line_ends_kept():
    assert printable("red \x1b[31m\nα \ud800") == "red \\x1b[31m\nα \\ud800"
    assert CostError("syntax", "a\x07b", 1, "c\x00d").text == "a\\x07b"


def test_a_long_text_is_cut():
    assert printable("x" * 50, longest=10) == "x" * 10


@pytest.mark.parametrize("name", ["", "  ", "a\nb", "\x1b[2J", "\ud800", "x" * (LONGEST_NAME + 1), 3, None])
def test_a_name_that_cannot_be_shown_is_no_term_name(name):
    assert not is_term_name(name)
    assert is_term_name("reach the box")
    assert is_term_name("x" * LONGEST_NAME)
