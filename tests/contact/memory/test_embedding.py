"""Texts as unit vectors, of which near ones mean near texts."""

import subprocess
import sys
import types

import numpy as np
import pytest

from coral.contact.memory.embedding import DEFAULT, HashedConcepts, HashedWords, embedder_of
from coral.errors import InputError


def similarity(first, second):
    words = HashedWords()
    return float(words.embed(first) @ words.embed(second))


def test_a_text_is_a_unit_vector_of_the_given_size():
    found = HashedWords(size=64).embed("Pick up the box")
    assert found.shape == (64,)
    assert found.dtype == np.float32
    assert np.linalg.norm(found) == pytest.approx(1.0)


def test_case_punctuation_and_small_words_do_not_count():
    assert similarity("Pick up the box, and lift it.", "pick box lift") == pytest.approx(1.0)


def test_common_words_make_texts_near():
    text = "Push the wooden block to the goal"
    near, far = similarity(text, "Push the block to the goal"), similarity(text, "Flip an upright carton")
    assert near > 0.5 > far


def test_the_order_of_words_counts_a_little():
    assert 0.5 < similarity("box on table", "table on box") < 0.99


def test_words_of_one_stem_are_nearer_than_others():
    assert similarity("grasped", "grasping") > similarity("grasped", "turning") + 0.3


@pytest.mark.parametrize("text", ["", "the of and", "123 !"])
def test_a_text_without_words_is_near_nothing(text):
    assert not HashedWords().embed(text).any()


def test_another_process_gives_the_same_vector():
    script = "from coral.contact.memory.embedding import HashedWords as H; print(H().embed('lift the box').tolist())"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == str(HashedWords().embed("lift the box").tolist())


def test_words_of_one_meaning_are_one_concept():
    concepts = HashedConcepts()
    first = concepts.embed("Raise the carton")
    assert first @ concepts.embed("lifting a parcel") == pytest.approx(1.0)
    assert first @ concepts.embed("Push the block") < 0.6
    assert first @ HashedConcepts().embed("Shut the lid") == pytest.approx(0.0)


def test_the_default_needs_no_package(monkeypatch):
    monkeypatch.setitem(sys.modules, "wordllama", None)
    assert embedder_of(DEFAULT).name == "hashed-concepts"
    assert embedder_of("words").name == "hashed-words"


def test_weights_that_load_are_used_and_their_vectors_have_length_one(monkeypatch):
    model = types.SimpleNamespace(embed=lambda texts: [[3.0, 4.0 * len(text)] for text in texts])
    loader = types.SimpleNamespace(load=lambda **_: model)
    monkeypatch.setitem(sys.modules, "wordllama", types.SimpleNamespace(WordLlama=loader, __file__="w/__init__.py"))
    assert embedder_of("wordllama").name == "wordllama-256"
    assert embedder_of("wordllama").embed("x") == pytest.approx([0.6, 0.8])


@pytest.mark.parametrize("broken", [None, sys])
def test_a_package_that_is_missing_or_does_not_load_is_named(monkeypatch, broken):
    monkeypatch.setitem(sys.modules, "wordllama", broken)
    with pytest.raises(InputError, match="embedder: found wordllama, which does not load"):
        embedder_of("wordllama")


def test_an_unknown_embedder_is_one_line_with_the_known_ones():
    with pytest.raises(InputError, match="one of wordllama, concepts, words"):
        embedder_of("concept")


def test_an_embedder_of_another_package_is_found_by_its_name(monkeypatch):
    made = HashedWords(size=8)
    monkeypatch.setattr("coral.contact.memory.embedding.named_plugin", lambda group, name, where, ours: lambda: made)
    assert embedder_of("mine") is made
