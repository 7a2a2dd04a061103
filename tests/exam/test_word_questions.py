from types import SimpleNamespace

import numpy as np
import pytest

from coral.exam import word_questions
from coral.exam.generation import make_word_set
from coral.exam.question_set import load_set, save_set
from coral.exam.score import score
from coral.exam.word_questions import _moment, word_item, word_items
from coral.reef.decide.mission_answer import MissionAnswer
from coral.reef.world.generated import find_world


@pytest.fixture(scope="module")
def item(small_stills):
    """Of a tour that ends early: every look of it is painted."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(word_questions, "GOALS", 3)
        return word_item(find_world("words:living:21"), np.random.default_rng(0))


def test_a_question_is_that_of_a_mission_and_its_key_is_not_shown(item):
    assert item.kind == "reef-mission"
    assert find_world(item.group.replace("-", ":")).mission.instruction in item.prompt
    assert {"map", "colour", "things"} <= {picture.name for picture in item.pictures}
    told = item.prompt + str(item.facts)
    assert "living-clump" not in told


def test_some_dots_are_right_and_others_are_not(item):
    key = item.key
    assert set(key["right"]) <= set(key["wanted"])
    assert key["unwanted"]
    assert not set(key["wanted"]) & set(key["unwanted"])
    assert {str(dot) for dot in (*key["wanted"], *key["unwanted"])} <= set(key["kinds"])
    living = {dot for dot in (*key["wanted"], *key["unwanted"]) if key["kinds"][str(dot)] == "living-clump"}
    assert living == set(key["wanted"])


def test_an_answer_is_scored(item):
    right, wrong = (MissionAnswer(selected_centroid_index=item.key[name][0]) for name in ("right", "unwanted"))
    assert (score(item, right).score, score(item, wrong).score) == (0.5, 0.0)


def test_no_dot_stands_for_an_animal_that_passes():
    world = find_world("words:living:0")
    clump, dead = (
        next(one for one in world.things if one.kind.startswith(kind)) for kind in ("living", ("dead", "mus"))
    )
    fish = next(one for one in world.things if one.kind == "fish")
    beside = fish.model_copy(update={"x": clump.x + 0.4, "y": clump.y})
    world = world.model_copy(update={"things": (beside, *(one for one in world.things if one is not fish))})
    tracks = [SimpleNamespace(index=1, x=beside.x, y=beside.y), SimpleNamespace(index=2, x=dead.x, y=dead.y)]
    views = SimpleNamespace(of=lambda tracks: [(track, None, 0.0) for track in tracks])
    outlook = SimpleNamespace(
        belief=SimpleNamespace(tracks=tracks, best_views=views), done=lambda track: False, unvisited=lambda: tracks
    )
    assert _moment(world, outlook, 0.0, []).key["kinds"] == {"1": "living-clump", "2": dead.kind}


def test_missions_of_the_other_half(monkeypatch, item):
    asked = []
    monkeypatch.setattr("coral.exam.word_questions.word_item", lambda world, rng: asked.append(world.name) or item)
    found = word_items("test", 4, 2)
    assert {"words-net-104", "words-net-105"} <= set(asked)
    assert [one.id for one in found[:2]] == ["reef-mission-000", "reef-mission-001"]


def test_a_set_is_read_back(tmp_path, monkeypatch, item):
    monkeypatch.setattr("coral.exam.generation.word_items", lambda half, seed, each: [item])
    made = make_word_set("words", "development", 3, 1)
    save_set(tmp_path / "words.zip", made)
    (again,) = load_set(str(tmp_path / "words.zip")).items
    assert (again.prompt, dict(again.key)) == (item.prompt, item.key)
