import pytest

from coral.exam.word_score import names_kind, score_mission
from coral.reef.decide.mission_answer import LookFrom, Mark, MissionAnswer
from coral.reef.world.kinds import catalogue

KEY = {
    "kinds": {"1": "tyre", "2": "ghost-net", "3": "mussels", "4": "crab-pot"},
    "right": [2],
    "wanted": [2, 4],
    "unwanted": [1, 3],
}


def worth(**answer):
    return score_mission(KEY, {}, MissionAnswer(**answer)).score


def marks(*labels):
    return tuple(Mark(dot=dot, label=label) for dot, label in enumerate(labels, 1))


def test_all_of_it_right_is_worth_one():
    named = marks("a car tyre", "fishing net", "mussel bed", "crab trap")
    assert worth(selected_centroid_index=2, skip=(1, 3), marks=named) == 1.0
    assert worth(look=LookFrom(dot=2, side="far"), skip=(1, 3), marks=named) == 1.0


def test_each_part_has_its_share():
    assert worth(selected_centroid_index=2) == 0.5
    assert worth(selected_centroid_index=1) == 0.0
    assert worth(done=True) == 0.0
    assert worth(selected_centroid_index=1, skip=(3,)) == pytest.approx(0.125)
    assert worth(selected_centroid_index=1, marks=marks("tyre", "tyre")) == pytest.approx(0.0625)


def test_to_rule_out_everything_is_worth_nothing():
    assert worth(selected_centroid_index=1, skip=(1, 2, 3, 4)) == 0.0


@pytest.mark.parametrize("kind", sorted(catalogue().kinds))
def test_every_kind_is_named_by_what_a_person_calls_it(kind):
    says = catalogue().kinds[kind].says
    assert names_kind(says, kind)
    others = [other for other in catalogue().kinds if other.partition("-")[0] != kind.partition("-")[0]]
    assert not any(names_kind(says, other) for other in others)


@pytest.mark.parametrize("label", ["", "something", "a rock"])
def test_words_of_no_kind_name_none(label):
    assert not any(names_kind(label, kind) for kind in catalogue().kinds)
