"""Ground truth never enters what an advisor is shown."""

from dataclasses import replace

import numpy as np
import pytest

from coral.contact.scene.trial import PhysicalParameters
from coral.exam import contact_questions
from coral.exam.contact_scenes import made_of
from coral.exam.reef_moments import moments
from coral.exam.reef_regret import INSPECTED_M, TrueReef
from coral.reef.world.world import load_world


@pytest.mark.parametrize("make", ["_parameters", "_regions", "_poses"])
def test_true_parameters_change_the_key_and_nothing_that_is_shown(make, monkeypatch):
    def other(task, seed):
        trial = made_of(task, seed)
        heavier = {
            name: replace(item, physical=PhysicalParameters(2.0 * item.physical.mass_kg, 0.123))
            for name, item in trial.objects.items()
        }
        return replace(trial, objects=heavier)

    one = getattr(contact_questions, make)("pick-box", 5)
    monkeypatch.setattr(contact_questions, "made_of", other)
    two = getattr(contact_questions, make)("pick-box", 5)
    assert one.question() == two.question()
    assert (one.key != two.key) == (make == "_parameters")


def test_clusters_out_of_sight_change_the_key_and_nothing_that_is_shown():
    world = load_world("l1")
    far = world.clusters[-1]
    moved = far.model_copy(update={"oysters": tuple(o.model_copy(update={"x": o.x - 1.0}) for o in far.oysters)})
    other = world.model_copy(update={"clusters": (*world.clusters[:-1], moved)})
    shown, keys = [], []
    for each in (world, other):
        reef = TrueReef(each)
        first = next(moments(each, reef.clusters, np.random.default_rng(0), INSPECTED_M))
        shown.append(first.question)
        points = np.array([p for p in first.options.values() if not isinstance(p, str)])
        keys.append(reef.seconds(first.pose, points, first.left))
    assert shown[0] == shown[1]
    assert not np.array_equal(keys[0], keys[1])


def test_no_key_is_among_what_is_shown(few):
    for item in few.items:
        question = item.question()
        assert not hasattr(question, "key")
        for name in ("seconds", "touches", "trial"):
            assert name not in question.facts
        assert "hidden" not in question.prompt
