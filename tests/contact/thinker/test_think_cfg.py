import pytest

from coral.advisor.consult import BudgetCfg
from coral.contact.thinker.think_cfg import DESK_S, MODEL_S, decision_budget


@pytest.mark.parametrize(
    ("advisor", "unset_s"), [("heuristic", MODEL_S), ("desk", DESK_S), ("fallible:0.1:desk", DESK_S)]
)
def test_a_deadline_that_was_set_stays_though_it_is_that_of_a_model(advisor, unset_s):
    assert decision_budget(BudgetCfg(), advisor).deadline_s == unset_s
    assert decision_budget(BudgetCfg(max_requeries=1), advisor).deadline_s == unset_s
    assert decision_budget(BudgetCfg(deadline_s=MODEL_S), advisor).deadline_s == MODEL_S
