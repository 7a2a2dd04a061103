import pytest
from pydantic import ValidationError

from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.plan.plan_revision import PlanRevision

BEFORE = PlanAnswer(code="before")


def test_a_plan_is_kept_or_replaced():
    assert PlanRevision(keep=True).plan_after(BEFORE) is BEFORE
    assert PlanRevision(code="after", explanation="better").plan_after(BEFORE) == PlanAnswer(
        code="after", explanation="better"
    )


@pytest.mark.parametrize(
    "given", [{}, {"keep": True, "code": "x"}, {"code": "x", "stages": [{"name": "a", "code": "y"}]}]
)
def test_both_or_neither_is_no_answer(given):
    with pytest.raises(ValidationError):
        PlanRevision.model_validate(given)
