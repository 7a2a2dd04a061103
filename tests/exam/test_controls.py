import asyncio

import numpy as np
import pytest
from recorded import RULES

from coral.advisor.rules import RuleAdvisor
from coral.exam.asking import ask_all
from coral.exam.controls import CONTROLS, control
from coral.exam.grading import Grader
from coral.exam.question_set import load_set
from coral.exam.result import Result
from coral.reef.decide.heuristic import REEF_RULES

QUICK = ("reef-centroid", "reef-waypoint", "physical-parameters", "contact-regions")


@pytest.mark.parametrize("name", CONTROLS)
def test_controls_give_valid_answers_to_every_kind(name, few):
    advisor = control(name, np.random.default_rng(0))
    for item in few.items:
        answer = asyncio.run(advisor.answer(item.question(), ())).value
        assert isinstance(answer, item.question().answer_type)


def test_who_knows_nothing_scores_far_below_the_rules():
    items = load_set("public", QUICK, 10).items
    scores = {}
    for name in ("random", "constant", "rules"):
        advisor = RuleAdvisor({**REEF_RULES, **RULES}) if name == "rules" else control(name, np.random.default_rng(0))
        scores[name] = Result(name=name, graded=tuple(Grader().grade(ask_all(advisor, items)))).row()
    assert scores["random"]["score"] < 0.5 * scores["rules"]["score"]
    assert scores["random"]["high"] < scores["rules"]["low"]
    assert scores["constant"]["high"] < scores["rules"]["low"]
