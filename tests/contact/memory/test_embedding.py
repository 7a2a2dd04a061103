"""Texts as unit vectors, of which near ones mean near texts."""

import subprocess
import sys

import numpy as np
import pytest

from coral.contact.memory.embedding import DEFAULT, HashedConcepts, embedder_of
from coral.errors import InputError


def similarity(first, second):
    words = HashedConcepts()
    return float(words.embed(first) @ words.embed(second))


def test_a_text_is_a_unit_vector_of_the_given_size():
    found = HashedConcepts(size=64).embed("Pick up the box")
    assert found.shape == (64,)
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
    assert not HashedConcepts().embed(text).any()


def test_another_process_gives_the_same_vector():
    script = "from coral.contact.memory.embedding import HashedConcepts as H; print(H().embed('lift the box').tolist())"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == str(HashedConcepts().embed("lift the box").tolist())


def test_words_of_one_meaning_are_one_concept():
    concepts = HashedConcepts()
    first = concepts.embed("Raise the carton")
    assert first @ concepts.embed("lifting a parcel") == pytest.approx(1.0)
    assert first @ concepts.embed("Push the block") < 0.6
    assert first @ HashedConcepts().embed("Shut the lid") == pytest.approx(0.0)


def test_an_unknown_embedder_is_one_line_with_the_known_ones():
    with pytest.raises(InputError, match="concepts"):
        embedder_of("concept")
    assert embedder_of(DEFAULT).name == "hashed-concepts"


def test_an_embedder_of_another_package_is_found_by_its_name(monkeypatch):
    made = HashedConcepts(size=8)
    monkeypatch.setattr("coral.contact.memory.embedding.named_plugin", lambda group, name, where, ours: lambda: made)
    assert embedder_of("mine") is made
