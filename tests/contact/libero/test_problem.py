"""A problem file: what is on the table, and what is to be moved where."""

import pytest

from coral.contact.libero.problem import read_problem
from coral.errors import InputError

TEXT = """(define (problem Floor) (:domain robosuite) ; a comment with (
  (:language Pick the can and place it in the bin)
  (:objects slab_1 slab_2 - slab can_1 - can bin_1 - bin)
  (:goal (And (In can_1 bin_1_hold_region))))"""


@pytest.fixture
def read(tmp_path):
    def from_text(old="", new=""):
        assert old in TEXT
        path = tmp_path / "task.bddl"
        path.write_text(TEXT.replace(old, new), encoding="utf-8")
        return read_problem(path)

    return from_text


def test_objects_come_with_their_kinds_in_the_order_of_the_file(read):
    found = read()
    assert list(found.objects.items()) == [("slab_1", "slab"), ("slab_2", "slab"), ("can_1", "can"), ("bin_1", "bin")]
    assert found.language == "Pick the can and place it in the bin"
    assert (found.target, found.container, found.region) == ("can_1", "bin_1", "hold_region")


def test_a_single_goal_needs_no_and(read):
    assert read("(And (In can_1 bin_1_hold_region))", "(In can_1 bin_1_hold_region)").target == "can_1"


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("(In can_1", "(On can_1", "OBJECT REGION"),
        ("(In can_1", "(In jar_1", "OBJECT REGION"),
        ("(:objects", "(:things", "LIBERO problem file"),
        ("bin_1_hold", "can_2_hold", "a region of one of"),
        ("bin_1_hold", "can_1_hold", "a region of one of"),
        (" - bin)", ")", "NAME ... - KIND"),
        ("- slab", "- ../slab", "NAME ... - KIND"),
        (TEXT, ") (", "LIBERO problem file"),
        ("(:language Pick", "(:language (Pick)", ":language: found parentheses"),
        ("(In can_1", "(In (can_1)", "OBJECT REGION"),
    ],
)
def test_a_damaged_problem_is_named(old, new, expected, read):
    with pytest.raises(InputError, match=expected) as caught:
        read(old, new)
    assert "task.bddl" in str(caught.value)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"absent\.bddl: found no such file"):
        read_problem(tmp_path / "absent.bddl")
