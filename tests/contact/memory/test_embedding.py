"""Texts as unit vectors, of which near ones mean near texts."""

import subprocess
import sys
import types

import numpy as np
import pytest

from coral.contact.memory.embedding import HashedWords, best_embedder


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


@pytest.fixture
def anew():
    best_embedder.cache_clear()
    yield
    best_embedder.cache_clear()


@pytest.mark.usefixtures("anew")
def test_without_weights_words_are_hashed(monkeypatch):
    monkeypatch.setitem(sys.modules, "wordllama", None)
    assert best_embedder().name == "hashed-words"
    assert best_embedder() is best_embedder()


@pytest.mark.usefixtures("anew")
def test_weights_that_load_are_used_and_their_vectors_have_length_one(monkeypatch):
    model = types.SimpleNamespace(embed=lambda texts: [[3.0, 4.0 * len(text)] for text in texts])
    loader = types.SimpleNamespace(load=lambda **_: model)
    monkeypatch.setitem(sys.modules, "wordllama", types.SimpleNamespace(WordLlama=loader, __file__="w/__init__.py"))
    assert best_embedder().name == "wordllama-256"
    assert best_embedder().embed("x") == pytest.approx([0.6, 0.8])


@pytest.mark.usefixtures("anew")
def test_weights_that_do_not_load_are_no_error(monkeypatch):
    monkeypatch.setitem(sys.modules, "wordllama", sys)  # a module that has no WordLlama
    assert best_embedder().name == "hashed-words"
