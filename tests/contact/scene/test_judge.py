"""Episodes that succeed and episodes that cannot any more."""

import pytest
from contact_bench import body, make_trial, plain, touch, truth

from coral.contact.scene.judge import Judge


def test_success_needs_an_unbroken_hold():
    judge = Judge(make_trial({"kind": "released"}))
    assert not judge.success(truth(0.0))
    assert not judge.success(truth(0.08))
    assert not judge.success(truth(0.09, body(), touch("box", "hand")))  # broken
    assert not judge.success(truth(0.10))
    assert not judge.success(truth(0.19))
    assert judge.success(truth(0.20))


def test_all_conditions_hold_at_once():
    judge = Judge(make_trial({"kind": "released"}, {"kind": "undisturbed"}))
    for k in range(20):
        away = body((0.2, 0, 0.03)) if k % 2 else body()
        contacts = () if k % 2 else (touch("box", "hand"),)
        assert not judge.success(truth(0.05 * k, away, *contacts))
    assert judge.holding == (True, False)


def test_only_what_can_never_hold_again_is_broken():
    judge = Judge(make_trial({"kind": "never-touched", "thing": "hand"}, {"kind": "released"}))
    assert judge.broken == ()
    judge.success(truth(0.0))
    assert judge.broken == ()
    judge.success(truth(0.02, body(), touch("box", "hand")))
    judge.success(truth(0.04))
    assert [one.kind for one in judge.broken] == ["never-touched"]


@pytest.mark.parametrize(
    ("position", "failure"),
    [
        ((0, 0, 0.03), None),
        ((0, 0, 0.005), None),
        ((0, 0, -0.02), "tunnelling: box"),
        ((0.41, 0, -0.02), None),  # over the edge, not yet lost
        ((0.5, 0, -0.2), "dropped: box"),
        ((0, -0.5, -0.2), "dropped: box"),
        ((0.5, 0, 0.3), None),
    ],
)
def test_failures(position, failure):
    assert Judge(make_trial()).failure(truth(0, body(position))) == failure


def test_tunnelling_is_told_wherever_an_objects_origin_lies():
    tall = plain()["objects"][0] | {"parts": [{"size": [0.04, 0.04, 0.1], "position": [0, 0, -0.3]}]}
    judge = Judge(make_trial(objects=[tall]))
    assert judge.failure(truth(0, body((0, 0, 0.35)))) is None
    assert judge.failure(truth(0, body((0, 0, 0.2)))) == "tunnelling: box"


WALL = {"name": "wall", "size": [0.05, 0.6, 0.2], "position": [0.2, 0.3, 0.1], "yaw_deg": 90}


@pytest.mark.parametrize(
    ("way", "failure"),
    [
        ([(-0.2, 0.2, 0.03), (-0.2, 0.39, 0.03)], None),  # past the wall's end: it stands along x
        ([(0.2, 0.2, 0.03), (0.2, 0.279, 0.03)], None),  # pressed into it
        ([(0.2, 0.2, 0.03), (0.2, 0.281, 0.03)], "tunnelling: box"),
        ([(0.2, 0.2, 0.03), (0.2, 0.39, 0.03)], "tunnelling: box"),  # through it between two looks
        ([(0.2, 0.2, 0.03), (0.2, 0.2, 0.3), (0.2, 0.39, 0.3), (0.2, 0.39, 0.03)], None),  # over it
    ],
)
def test_what_goes_through_a_fixture_has_tunnelled(way, failure):
    judge = Judge(make_trial(fixtures=[WALL]))
    said = [judge.failure(truth(0.02 * k, body(place))) for k, place in enumerate(way)]
    assert said[:-1] == [None] * (len(way) - 1)
    assert said[-1] == failure


def test_the_table_may_stand_elsewhere():
    moved = plain() | {"table": {"center": [1.0, 0.0]}}
    moved["objects"][0]["x"] = 1.0
    judge = Judge(make_trial(**moved))
    assert judge.failure(truth(0, body((1.0, 0, -0.02)))) == "tunnelling: box"
    assert judge.failure(truth(0, body((0.0, 0, -0.2)))) == "dropped: box"
