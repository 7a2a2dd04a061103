"""Words of manipulation by meaning."""

import subprocess
import sys

import numpy as np
import pytest

from coral.contact.memory.wording import (
    CONCEPTS,
    concept_of,
    concepts_of,
    contradict,
    embed,
)


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


def similarity(first, second):
    return float(embed(first) @ embed(second))


def test_a_text_is_a_unit_vector_():
    found = embed("Pick up the box")
    assert found.dtype == np.float32
    assert np.linalg.norm(found) == pytest.approx(1.0)


def test_case_punctuation_and_small_words_do_not_count():
    assert similarity("Pick up the box, and lift it.", "pick box lift") == pytest.approx(1.0)


def test_common_words_make_texts_near():
    text = "Push the wooden block to the goal"
    near, far = similarity(text, "Push the block to the goal"), similarity(text, "Flip an upright carton")
    assert near > 0.5 > far


@pytest.mark.parametrize("text", ["", "the of and", "123 !"])
def test_a_text_without_words_is_near_nothing(text):
    assert not embed(text).any()


def test_another_process_gives_the_same_vector():
    script = "from coral.contact.memory.wording import embed; print(embed('lift the box').tolist())"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == str(embed("lift the box").tolist())


def test_words_of_one_meaning_are_one_concept():
    first = embed("Raise the carton")
    assert first @ embed("lifting a parcel") == pytest.approx(1.0)
    assert first @ embed("Push the block") < 0.6
    assert first @ embed("Shut the lid") == pytest.approx(0.0)
