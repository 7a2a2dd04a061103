import asyncio

from recorded import RULES

from coral.advisor.rules import RuleAdvisor
from coral.contact.plan.cost_plan import PlanAnswer
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
