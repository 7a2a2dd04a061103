"""Words of manipulation by meaning."""

import pytest

from coral.contact.memory.wording import CONCEPTS, concept_of, concepts_of, contradict


@pytest.mark.parametrize(
    ("word", "concept"),
    [
        ("raise", "lift"),
        ("raised", "lift"),
        ("shoving", "push"),
        ("gripped", "hold"),
        ("boxes", "box"),
        ("azure", "blue"),
    ],
)
def test_a_word_in_any_inflection_has_its_concept(word, concept):
    assert concept_of(word) == concept


def test_a_word_without_a_concept_stands_for_itself():
    assert concepts_of("Juggle the parcel!") == ["juggle", "the", "box"]


def test_concepts_are_named_by_a_word_that_means_them():
    assert [name for name in CONCEPTS if concept_of(name) != name and name not in ("cylinder", "clutter")] == []


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        ("Push the crate to the goal.", "Carry the crate to the goal.", True),
        ("Carry the crate to the goal.", "Push the crate to the goal.", True),
        ("Push the crate to the goal.", "Slide the box to the mark.", False),
        ("Push the board, then lift it.", "Lift the board.", False),
        ("Close the drawer.", "Pull the drawer out.", True),
        ("Take the can.", "Put the can away.", False),
    ],
)
def test_actions_that_exclude_each_other_contradict(first, second, expected):
    assert contradict(first, second) is expected
