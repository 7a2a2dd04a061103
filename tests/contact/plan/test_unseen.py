"""Costs and conditions that read an object which was never seen wait for it."""

import dataclasses

import numpy as np
import pytest

from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer, make_strategy
from coral.contact.thinker.scene_facts import scene_facts
from coral.contact.thinker.scene_text import scene_text, told_in_scene

CODE = "def state_cost(self):\n    return {'off': norm(self.ee_pos - self.box_pos)}"
STAGES = [
    {
        "name": "a",
        "code": CODE,
        "done": "self.box_pos[2] < 9",
        "next": {"b": "self.box_seen"},
        "toward": "self.box_pos",
    },
    {"name": "b", "code": "def state_cost(self):\n    return {'up': 1.0 - self.ee_pos[2]}", "done": "self.time < 9"},
    {"name": "c", "code": CODE},
]


@pytest.fixture
def followed(scene):
    one = scene("pick-box")
    stages = make_strategy("x", PlanAnswer.model_validate({"stages": STAGES}), None, one.world.schema, one.sizes).stages
    hidden = dataclasses.replace(one.now, unseen=frozenset({"box"}))
    return stages, one.world.present(one.now), one.world.present(hidden)


def test_a_cost_that_reads_it_keeps_the_hand_where_it_is(followed):
    (first, other, _), seen, hidden = followed
    assert list(first.cost(seen)) == ["off"]
    assert list(first.cost(hidden)) == ["wait for box"]
    assert list(other.cost(hidden)) == ["up"]


def test_a_condition_that_reads_it_does_not_hold_but_one_may_ask_whether_it_was_seen(followed):
    (first, other, _), seen, hidden = followed
    assert (first.until(seen), first.until(hidden), other.until(hidden)) == (True, False, True)
    assert (first.next[0][1](seen), first.next[0][1](hidden)) == (True, False)


def test_the_scene_says_what_was_not_seen_and_only_then_tells_of_the_quantity(scene):
    one = scene("pick-box")
    hidden = dataclasses.replace(one.now, unseen=frozenset({"box"}))
    facts, unknown = scene_facts(one.trial, one.now), scene_facts(one.trial, hidden)
    assert "box_seen" in told_in_scene(facts)
    assert "box_seen" not in told_in_scene(unknown)
    assert "Not seen yet" not in scene_text(facts)
    low, high = one.trial.task.objects[0].x
    assert f"Not seen yet, its pose a guess: box (somewhere in x {low:g} to {high:g}, y " in scene_text(unknown)


def test_an_object_lost_on_the_way_is_not_seen_and_only_what_asks_for_that_waits(scene, followed):
    one, (stages, seen, _) = scene("pick-box"), followed
    now = dataclasses.replace(one.now, lost=frozenset({"box"}))
    lost = one.world.present(now)
    assert (float(seen.box_seen.flat[0]), float(lost.box_seen.flat[0])) == (1.0, 0.0)
    # The hand itself hides what it reaches for: costs and conditions go on with the pose last seen.
    assert list(stages[0].cost(lost)) == ["off"]
    assert (stages[0].until(lost), stages[0].next[0][1](lost)) == (True, False)
    facts = scene_facts(one.trial, now)
    assert "Out of sight now, its pose the last one seen: box." in scene_text(facts)
    assert "box_seen" not in told_in_scene(facts)


def test_nothing_is_told_of_where_an_object_may_be_that_another_carries(scene):
    one = scene("pick-box")
    on_top = one.trial.task.objects[0].model_copy(update={"stands_on": "crate"})
    task = one.trial.task.model_copy(update={"objects": (on_top,)})
    hidden = dataclasses.replace(one.now, unseen=frozenset({"box"}))
    facts = scene_facts(dataclasses.replace(one.trial, task=task), hidden)
    assert "Not seen yet, its pose a guess: box. " in scene_text(facts)


def test_nothing_leads_to_its_guessed_place(scene):
    one = scene("pick-box")
    plan = PlanAnswer.model_validate({"stages": STAGES})
    first = make_strategy("x", plan, RegionsAnswer({}), one.world.schema, one.sizes).stages[0]
    hidden = one.world.present(dataclasses.replace(one.now, unseen=frozenset({"box"})))
    assert np.allclose(first.guides[0].points(hidden), hidden.ee_pos[0])
