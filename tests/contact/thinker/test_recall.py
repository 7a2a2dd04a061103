"""The choice among remembered plans."""

import json

import numpy as np
import pytest
from experiences import experience

from coral.advisor.rules import RuleAdvisor
from coral.contact.memory.embedding import HashedWords
from coral.contact.memory.memory import Memory, MemoryCfg
from coral.contact.plan.cost_plan import in_process
from coral.contact.plan.imagined_outcome import ImaginedOutcome
from coral.contact.rules.answers import RULES
from coral.contact.thinker.asker import Asker
from coral.contact.thinker.questions import Questions
from coral.contact.thinker.recall import Recall, adaptations
from coral.contact.thinker.think_cfg import ThinkCfg

BAD, GOOD = ImaginedOutcome(False, 0.3, 0.5, 1.0), ImaginedOutcome(True, 1.0, 1.0, 1.0)


@pytest.fixture
def memory(tmp_path):
    return Memory(tmp_path / "m.sqlite", embedder=HashedWords())


def choose(one, memory, outcomes=(), **cfg):
    """The chosen plan, the events, and what was rehearsed; outcomes, if any, take the place of rehearsals."""
    think = ThinkCfg(memory=MemoryCfg(**cfg))
    told, rehearsed, left = [], [], list(outcomes)
    questions = Questions(
        Asker(RuleAdvisor(RULES)), one.trial, one.world, think, in_process, RULES, lambda *_, **__: None
    )
    questions.update_facts(one.now)
    recall = Recall(questions, one.trial, one.world, think, np.random.default_rng(0), in_process)

    def rehearse(plan, first):
        rehearsed.append(plan)
        return left.pop(0)

    if outcomes:
        recall._rehearse = rehearse
    chosen = recall.choose(memory, one.now, lambda event, **fields: told.append(fields))
    return chosen, told, rehearsed


def test_each_plan_is_adapted_in_two_ways_if_they_differ(scene, memory):
    one, other = scene("pick-box", 0), scene("pick-box", 2)
    memory.add(experience(one))
    assert [each.scaled for each in adaptations(memory, one.facts)] == [True]
    assert [each.scaled for each in adaptations(memory, other.facts)] == [True, False]


@pytest.mark.parametrize(("outcomes", "scaled"), [([BAD, GOOD], False), ([GOOD, BAD], True), ([GOOD, GOOD], True)])
def test_the_one_that_came_further_is_followed_and_the_other_is_told_of(scene, memory, outcomes, scaled):
    memory.add(experience(scene("pick-box", 0)))
    chosen, told, rehearsed = choose(scene("pick-box", 2), memory, outcomes)
    assert len(rehearsed) == 2
    assert chosen.scaled is scaled
    assert chosen.outcome == GOOD
    assert [bool(fields["refused"]) for fields in told] == [not scaled, scaled]
    assert [fields.get("source") for fields in told].count("memory") == 1


def test_one_alone_is_not_rehearsed(scene, memory):
    one = scene("pick-box", 0)
    memory.add(experience(one))
    chosen, told, rehearsed = choose(one, memory)
    assert (chosen.match.stored.id, rehearsed) == (1, [])
    assert [(fields["refused"], fields["outcome"]) for fields in told] == [("", None)]


def test_without_rehearsals_the_first_that_passes_is_followed(scene, memory):
    memory.add(experience(scene("pick-box", 0)))
    chosen, told, rehearsed = choose(scene("pick-box", 2), memory, rehearsed=1)
    assert (chosen.scaled, len(told), rehearsed) == (True, 1, [])


def test_a_plan_that_cannot_be_used_is_refused_with_the_reason(scene, memory):
    one = scene("pick-box", 0)
    held = json.loads(experience(one).model_dump_json().replace("self.box_left_contact", "self.box_third_contact"))
    memory.add(type(experience(one)).model_validate(held))
    chosen, told, _ = choose(one, memory)
    assert chosen is None
    assert "third_contact" in told[0]["refused"]
    assert "source" not in told[0]


def test_an_empty_memory_offers_nothing(scene, memory):
    assert choose(scene("pick-box"), memory) == (None, [], [])


def test_a_rehearsal_follows_the_plan_in_the_planning_world(scene, memory, monkeypatch):
    memory.add(experience(scene("pick-box", 0)))
    followed = []

    def watch(world, strategy, now):
        followed.append([(stage.name, bool(stage.guides)) for stage in strategy.stages])
        return []

    monkeypatch.setattr("coral.contact.thinker.recall.imagine", watch)
    chosen, told, _ = choose(scene("pick-box", 2), memory)
    assert followed == [[("reach", True), ("close", False), ("lift", True)]] * 2
    assert chosen.outcome == ImaginedOutcome(False, 0.0, 0.0, 0.0)
    assert [fields["outcome"]["stages"] for fields in told] == [0.0, 0.0]
