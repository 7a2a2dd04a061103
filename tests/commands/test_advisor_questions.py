from dataclasses import replace

import pytest

from coral.exam.generation import CONTACT, REEFS
from coral.exam.question_set import load_set


@pytest.fixture
def made(monkeypatch):
    """What was asked of the generator, which takes a minute for the smallest set; three public questions instead."""
    asked = []

    def make_set(name, seed, reefs, counts, say, shipped):
        asked.append((name, seed, reefs, counts, shipped))
        say("generating")
        return replace(load_set("public", ["object-poses"], 3), name=name)

    monkeypatch.setattr("coral.commands.advisor_questions.make_set", make_set)
    return asked


def test_a_set_is_made_from_its_seed_and_named_after_its_file(told, made, tmp_path):
    path = tmp_path / "second.zip"
    words = ("--seed", "3", "--reefs", "5", "--json")
    code, result, err = told("advisor", "questions", *words, "--out", path)
    assert (code, err, result["set"]) == (0, "generating\n", "second")
    assert result["bytes"] == path.stat().st_size
    assert sum(result["questions"].values()) == len(load_set(str(path)).items) == 3
    assert made == [("second", 3, 5, CONTACT, REEFS)]


def test_a_share_makes_fewer_of_each_kind_but_never_none(told, made, tmp_path):
    words = ("--seed", "3", "--share", "0.01", "--quiet")
    code, text, err = told("advisor", "questions", *words, "--out", tmp_path / "few.zip")
    assert (code, err) == (0, "")
    assert text.startswith("3 questions (")
    (_, _, _, counts, shipped) = made[0]
    assert set(counts) == set(CONTACT)
    assert 1 <= min(counts.values()) <= max(counts.values()) < max(CONTACT.values())
    assert len(shipped) == 1


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--seed", "-1"), "--seed: found -1"),
        (("--seed", "1", "--reefs", "-1"), "--reefs: found -1"),
        (("--seed", "1", "--share", "0"), "--share: found 0"),
        (("--seed", "1", "--share", "nan"), "--share: found nan"),
        (("--seed", "1", "--out", "there.zip"), "--out: found an existing file, expected a new file"),
        (("--seed", "1", "--out", "set.tar"), "--out: found 'set.tar'"),
    ],
)
def test_bad_flags_are_refused_before_anything_is_made(refused, made, tmp_path, monkeypatch, words, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there.zip").write_bytes(b"mine")
    out = () if "--out" in words else ("--out", "new.zip")
    assert said in refused("advisor", "questions", *words, *out)
    assert made == []
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [b"mine"]


def test_a_half_of_the_unseen_suite_is_asked_for_instead(told, tmp_path, monkeypatch):
    asked = []

    def make(name, half, seed):
        asked.append((name, half, seed))
        return replace(load_set("public", ["cost-function"], 1), name=name)

    monkeypatch.setattr("coral.commands.advisor_questions.make_unseen_set", make)
    words = ("--seed", "4", "--unseen", "test")
    code, text, _ = told("advisor", "questions", *words, "--out", tmp_path / "half.zip")
    assert (code, asked) == (0, [("half", "test", 4)])
    assert text.startswith("1 questions (1 cost-function)")


def test_a_set_of_missions_in_words(told, monkeypatch, tmp_path):
    asked = []

    def make(name, half, seed, each):
        asked.append((name, half, seed, each))
        return replace(load_set("public", ["object-poses"], 3), name=name)

    monkeypatch.setattr("coral.commands.advisor_questions.make_word_set", make)
    words = ("--seed", "3", "--words", "test", "--each", "2")
    code, _, _ = told("advisor", "questions", *words, "--out", tmp_path / "words.zip")
    assert (code, asked) == (0, [("words", "test", 3, 2)])


def test_a_distance_without_kinds_is_refused(told, tmp_path):
    code, _, err = told("advisor", "questions", "--seed", "3", "--distance-m", "3", "--out", tmp_path / "far.zip")
    assert (code, err.count("\n")) == (2, 1)
    assert "--kinds WATER" in err
