"""The choice among remembered plans."""

import json
from dataclasses import replace

import pytest
from experiences import experience
from recorded import RULES, compose

from coral.advisor.rules import RuleAdvisor
from coral.contact.control.hand_controllers import PlannerLimits
from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.memory.memory import Memory, MemoryCfg, RememberedPlan
from coral.contact.plan.contact_regions import candidates
from coral.contact.plan.cost_plan import PlanAnswer, StageAnswer, in_process, make_strategy
from coral.contact.plan.imagined_run import ImaginedOutcome
from coral.contact.thinker.asker import Asker
from coral.contact.thinker.progress_monitor import OuterCfg
from coral.contact.thinker.questions import Questions
from coral.contact.thinker.recall import Recall, RecallRun, adaptations, try_recalled
from coral.contact.thinker.think_cfg import ThinkCfg

BAD, BETTER = ImaginedOutcome(False, 0.3, 0.5, 1.0), ImaginedOutcome(False, 0.6, 0.5, 1.0)
GOOD, THROUGH = ImaginedOutcome(True, 1.0, 1.0, 1.0), ImaginedOutcome(False, 1.0, 0.8, 1.0)


@pytest.fixture
def memory(tmp_path):
    return Memory(tmp_path / "m.sqlite")


def choose(one, memory, outcomes=(), **cfg):
    """The chosen plan, the events, and what was tried; outcomes, if any, take the place of checks and runs."""
    think = ThinkCfg(memory=MemoryCfg(**cfg))
    told, tried, left = [], [], list(outcomes)
    limits = lambda: PlannerLimits(ControllerCfg(), 0.04, 0.08)  # noqa: E731
    questions = Questions(
        Asker(RuleAdvisor(RULES)), one.trial, one.world, think, in_process, lambda *_, **__: None, limits
    )
    questions.update_facts(one.now)
    recall = Recall(questions, one.trial, one.world, think)

    def try_it(plan, first):
        tried.append(plan)
        outcome, refusal = left.pop(0)
        return replace(plan, refusal=refusal, run=RecallRun(outcome, 3.0, refusal))

    if outcomes:
        questions.check_plan = lambda *_, **__: None
        recall._try = try_it
    chosen = recall.choose(memory, one.now, lambda event, **fields: told.append(fields))
    return chosen, told, tried


def two_plans(scene, memory):
    """Remember two plans, of which the second comes first: it is the newer."""
    first = experience(scene("pick-box", 0))
    memory.add(first)
    memory.add(first.model_copy(update={"plan": first.plan.model_copy(update={"explanation": "Another."})}))


def test_equal_plans_are_adapted_once(scene, memory):
    one = scene("pick-box", 0)
    memory.add(experience(one))
    memory.add(experience(one, seed=1))
    assert len(memory.find(one.facts)) == 2
    assert len(list(adaptations(memory, one.facts))) == 1


@pytest.mark.parametrize(
    ("outcomes", "first"), [([BAD, GOOD], False), ([BAD, BAD], True), ([BAD, BETTER], False), ([BETTER, BAD], True)]
)
def test_the_one_that_came_further_is_followed_and_the_other_is_told_of(scene, memory, outcomes, first):
    two_plans(scene, memory)
    chosen, told, tried = choose(scene("pick-box", 2), memory, [(one, "") for one in outcomes])
    assert len(tried) == 2
    assert (chosen.match.stored.id == 2) is first
    assert chosen.run.outcome == max(outcomes)
    assert [bool(fields["refused"]) for fields in told] == [not first, first]
    assert [fields.get("source") for fields in told].count("memory") == 1


@pytest.mark.parametrize("outcome", [GOOD, THROUGH])
def test_after_one_that_comes_through_all_stages_nothing_more_is_tried(scene, memory, outcome):
    two_plans(scene, memory)
    chosen, told, tried = choose(scene("pick-box", 2), memory, [(outcome, "")])
    assert (chosen.match.stored.id, len(told), len(tried)) == (2, 1, 1)
    assert told[0]["rehearsed_s"] == 3.0


def test_a_plan_that_its_run_refuses_gives_way_to_the_next_however_far_it_came(scene, memory):
    two_plans(scene, memory)
    chosen, told, _ = choose(scene("pick-box", 2), memory, [(BETTER, "it breaks"), (BAD, "")])
    assert chosen.match.stored.id == 1
    assert [fields["refused"] for fields in told] == ["it breaks", ""]


def test_a_plan_comes_with_the_repairs_that_it_needed(scene, memory, monkeypatch):
    one = scene("pick-box", 0)
    held = experience(one)
    memory.add(held.model_copy(update={"then": [RememberedPlan(plan=held.plan, regions=held.regions)]}))
    told = []
    monkeypatch.setattr(
        "coral.contact.thinker.recall.try_recalled", lambda *args: told.append(args[-1]) or RecallRun(BAD, 2.5, "")
    )
    chosen, _, _ = choose(one, memory)
    assert chosen.steps[0].plan == chosen.steps[1].plan
    assert told == [True]


def test_if_all_are_refused_none_is_followed(scene, memory):
    two_plans(scene, memory)
    chosen, told, _ = choose(scene("pick-box", 2), memory, [(BETTER, "it breaks"), (BAD, "it falls back")])
    assert chosen is None
    assert [fields["refused"] for fields in told] == ["it breaks", "it falls back"]
    assert not any("source" in fields for fields in told)


def test_no_more_are_tried_than_allowed(scene, memory):
    two_plans(scene, memory)
    chosen, told, tried = choose(scene("pick-box", 2), memory, [(BAD, "")], rehearsed=1)
    assert (chosen.match.stored.id, len(told), len(tried)) == (2, 1, 1)


def test_without_runs_the_first_that_passes_is_followed(scene, memory):
    two_plans(scene, memory)
    chosen, told, tried = choose(scene("pick-box", 2), memory, rehearsed=0)
    assert (chosen.match.stored.id, len(told), tried) == (2, 1, [])
    assert (told[0]["refused"], told[0]["outcome"]) == ("", None)


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


def test_an_imagined_run_follows_the_plan_in_the_planning_world(scene, memory, monkeypatch):
    two_plans(scene, memory)
    followed = []

    def watch(world, trial, strategy, names, first, cfg, repaired):
        followed.append([stage.name for stage in strategy.stages])
        return RecallRun(BAD, 2.5, "")

    monkeypatch.setattr("coral.contact.thinker.recall.try_recalled", watch)
    chosen, told, _ = choose(scene("pick-box", 2), memory)
    assert followed == [["above", "lower", "close", "lift", "hold"]] * 2
    assert chosen.run.outcome == BAD
    assert [(fields["outcome"]["stages"], fields["rehearsed_s"]) for fields in told] == [(0.3, 2.5)] * 2


UP = "def state_cost(self):\n    return abs(self.ee_pos[2] - 0.35)"
STILL = "def state_cost(self):\n    return norm(self.ee_vel)"
SOON = OuterCfg(n_retry=3)


def tried(one, *stages, cfg=SOON, repaired=False):
    plan = PlanAnswer(stages=[StageAnswer(**stage) for stage in stages])
    strategy = make_strategy("x", plan, None, one.world.schema, one.sizes)
    return try_recalled(one.world, one.trial, strategy, plan.names, one.now, cfg, repaired)


def test_a_good_plan_succeeds_and_its_run_ends_then(scene):
    one = scene("pick-box")
    made = compose(one.facts)
    points = [candidates(region) for _, region in made.regions.each()]
    strategy = make_strategy("x", made.plan, made.regions, one.world.schema, one.sizes, in_process, points)
    found = try_recalled(one.world, one.trial, strategy, made.plan.names, one.now, OuterCfg())
    assert (found.outcome.succeeded, found.refusal) == (True, "")
    assert found.outcome.spare_s == pytest.approx(one.trial.task.time_limit_s - found.length_s, abs=0.2)


def test_a_plan_that_never_leaves_its_first_stage_is_refused_once_it_is_stuck(scene):
    one = scene("pick-box")
    found = tried(one, {"name": "wait", "code": STILL, "done": "self.ee_pos[2] < 0"}, {"name": "rise", "code": UP})
    assert found.refusal == "in an imagined run, it never left its first stage, 'wait'"
    assert found.length_s < 2.0 < one.trial.task.time_limit_s


def test_a_plan_that_was_repaired_then_may_be_stuck_now(scene):
    one = scene("pick-box")
    stages = {"name": "wait", "code": STILL, "done": "self.ee_pos[2] < 0"}, {"name": "rise", "code": UP}
    assert tried(one, *stages, repaired=True).refusal == ""


def test_a_plan_of_one_stage_that_gains_nothing_is_refused(scene):
    assert "met no condition" in tried(scene("pick-box"), {"name": "all", "code": UP}).refusal


def test_coming_to_the_last_stage_is_enough_for_others(scene):
    """What is believed to be too heavy is not lifted in imagination."""
    one = scene("pick-box")
    found = tried(one, {"name": "rise", "code": UP, "done": "self.ee_pos[2] > 0.28"}, {"name": "stay", "code": UP})
    assert (found.outcome.stages, found.refusal) == (1.0, "")


def test_one_that_is_stuck_between_is_not_refused_for_that(scene):
    one = scene("pick-box")
    rise = {"name": "rise", "code": UP, "done": "self.ee_pos[2] > 0.28"}
    stay = {"name": "stay", "code": UP, "done": "self.ee_pos[2] < 0"}
    found = tried(one, rise, stay, {"name": "never", "code": UP})
    assert (found.outcome.stages, found.refusal) == (pytest.approx(2 / 3), "")


def test_one_that_falls_back_twice_is_refused(scene):
    one = scene("pick-box")
    rise = {"name": "rise", "code": UP, "done": "self.time > 0"}
    stay = {"name": "stay", "code": UP, "done": "self.ee_pos[2] < 0", "lost": "self.time > 0", "back_to": "rise"}
    found = tried(one, rise, stay, {"name": "never", "code": UP})
    assert found.refusal == "in an imagined run, it fell back to an earlier stage 2 times"


def test_one_that_breaks_something_for_good_is_refused(scene, monkeypatch):
    one = scene("push-force")
    monkeypatch.setattr("coral.contact.plan.imagined_run.ImaginedJudge._broken", lambda *_: ("kept-level of block",))
    assert (
        tried(one, {"name": "all", "code": UP}).refusal == "in an imagined run, it breaks for good: kept-level of block"
    )
