import asyncio

import pytest

from coral.advisor.rules import RuleAdvisor
from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.rules.answers import RULES
from coral.contact.tasks import load_task
from coral.exam.contact_scenes import made_of, trial_from_json, trial_to_json
from coral.exam.question_set import load_set
from coral.exam.score import score

FLIP = "flip-box"


def flip_question():
    return next(item for item in load_set("public", ["cost-function"]).items if item.group.startswith(FLIP))


def test_a_plan_that_works_scores_and_one_that_is_refused_does_not():
    item = flip_question()
    rules = asyncio.run(RuleAdvisor(RULES).answer(item.question(), ())).value
    assert score(item, rules).score == 1.0
    flat = PlanAnswer(code="def state_cost(self):\n    return 1.0\n")
    assert score(item, flat).why == "refused: constant"


def test_a_trial_comes_back_from_json():
    trial = made_of(load_task("pick-clutter"), 7)
    again = trial_from_json(trial_to_json(trial))
    assert again.task == trial.task
    for name, item in trial.objects.items():
        assert again.objects[name].physical == item.physical
        assert list(again.objects[name].pose.position) == pytest.approx(list(item.pose.position), abs=0)
