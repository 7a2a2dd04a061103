import collections

import pytest

from coral.exam.question_set import load_set
from coral.exam.reef_questions import PER_WORLD, TELLING_S, reef_items


@pytest.fixture(scope="module")
def made():
    """The questions of one shipped reef, made with the seed of the shipped set."""
    return reef_items(17, 0, ("l1",))


def test_the_first_questions_are_the_shipped_ones(made, same):
    first = {item.kind: item for item in reversed(made)}
    for shipped in load_set("public", list(first), 1).items:
        same(first[shipped.kind], shipped)


def test_a_world_gives_no_more_questions_of_a_kind_than_it_may(made):
    count = collections.Counter(item.kind for item in made)
    assert set(count) <= set(PER_WORLD)
    assert all(count[kind] <= most for kind, most in PER_WORLD.items())
    assert {item.group for item in made} == {"l1"}
    assert [item.id for item in made] == [f"{kind}-{k:03d}" for kind in PER_WORLD for k in range(count[kind])]


def test_good_and_bad_answers_differ_or_most_are_refused(made):
    for item in made:
        seconds = item.key["seconds"].values()
        taken = [cost for cost in seconds if not isinstance(cost, str)]
        assert taken
        assert max(taken) - min(taken) >= TELLING_S or 2 * len(taken) <= len(seconds)


def test_every_choice_that_is_offered_has_its_seconds_or_its_refusal(made):
    for item in made:
        if item.kind == "reef-centroid":
            offered = {str(one["index"]) for one in item.facts["centroids"]}
            assert offered == set(item.key["seconds"])
        else:
            offered = {f"{one['forward_m']},{one['left_m']}" for one in item.facts["options"]}
            assert set(item.key["seconds"]) <= offered
        assert "" not in item.key["seconds"].values()


def test_without_a_world_there_is_no_question():
    assert reef_items(17, 0, ()) == []
