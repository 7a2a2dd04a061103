import asyncio

import pytest
from pydantic import BaseModel

from coral.advisor.question import AdvisorUnavailable, Question, Rejection
from coral.advisor.rules import RuleAdvisor


class Pick(BaseModel):
    index: int


class Same(BaseModel):
    index: int


RULES = {"pick": lambda facts, rejections: Pick(index=facts["n"] + len(rejections))}


def test_a_rule_reads_facts_and_rejections():
    for answer_type in (Pick, Same):
        question = Question(kind="pick", prompt="", answer_type=answer_type, facts={"n": 4})
        reply = asyncio.run(RuleAdvisor(RULES).answer(question, [Rejection(code="x", reason="y")]))
        assert reply.value == answer_type(index=5)
        assert reply.raw == '{"index":5}'


def test_a_question_without_a_rule_is_not_answered():
    with pytest.raises(AdvisorUnavailable, match="no rule for 'place', only for pick") as gone:
        asyncio.run(RuleAdvisor(RULES).answer(Question(kind="place", prompt="", answer_type=Pick, facts={}), ()))
    assert gone.value.final
