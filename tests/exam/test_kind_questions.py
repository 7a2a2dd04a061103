"""Questions that show every kind, to be named."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from coral.errors import InputError
from coral.exam.generation import make_kind_set
from coral.exam.question_set import load_set, save_set
from coral.exam.score import score
from coral.foreign_file import decode_picture
from coral.reef.decide.mission_answer import Mark, MissionAnswer
from coral.reef.world.kinds import catalogue


@pytest.fixture
def poses(monkeypatch):
    """Where pictures are taken from; they are black, since painting takes 10 s."""
    taken = []

    def of(frame, pose, t):
        taken.append(pose)
        return replace(frame, still=lambda: np.zeros((96, 128, 3), np.uint8))

    monkeypatch.setattr("coral.exam.kind_questions.make_stills", lambda *_: SimpleNamespace(of=of))
    return taken


def test_every_kind_is_shown_as_often_as_asked_and_read_back(poses, tmp_path):
    save_set(tmp_path / "kinds.zip", make_kind_set("kinds", "bay", 2.5, 3, 2))
    items = load_set(str(tmp_path / "kinds.zip")).items
    shown = [kind for item in items for kind in item.key["kinds"].values()]
    assert sorted(shown) == sorted(list(catalogue().kinds) * 2)
    assert len(set(items[0].key["kinds"].values())) < len(catalogue().kinds)  # nobody can tell the last by elimination
    assert len(poses) == len(shown)
    (picture,) = items[0].pictures
    assert decode_picture(picture.png).shape[:2] == (5 * 240, 4 * 240)
    assert "from 2.5 m" in items[0].prompt
    assert "living-clump" not in items[0].prompt


def test_the_score_is_the_share_that_is_named(poses):
    (item,) = make_kind_set("kinds", "clear", 2.0, 0, 1).items
    kinds = catalogue().kinds
    marks = [Mark(dot=int(dot), label=kinds[kind].says) for dot, kind in item.key["kinds"].items()]
    assert score(item, MissionAnswer(done=True, marks=tuple(marks))).score == 1.0
    wrong = next(k for k, mark in enumerate(marks) if "tyre" in mark.label)
    marks[wrong] = Mark(dot=wrong, label="a red crab")
    worth = score(item, MissionAnswer(done=True, marks=tuple(marks)))
    assert worth.score == pytest.approx(1.0 - 1.0 / len(kinds))
    assert worth.why.endswith(f"not {wrong}: tyre")


@pytest.mark.parametrize(("water", "distance_m", "said"), [("mud", 2.0, "--kinds"), ("clear", 0.5, "--distance-m")])
def test_an_unknown_water_or_distance_is_refused(water, distance_m, said):
    with pytest.raises(InputError, match=said):
        make_kind_set("kinds", water, distance_m, 0, 1)
