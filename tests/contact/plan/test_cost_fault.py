from cost_oracles import SCHEMA

from coral.contact.cost_program import CostProgram
from coral.contact.plan.cost_fault import quoted


def test_a_known_line_is_quoted_at_the_start_of_a_reason():
    cost = CostProgram("def state_cost(self):\n    return norm(self.ee_pos)", SCHEMA)
    assert quoted(cost, 2) == "line 2 (`return norm(self.ee_pos)`): "


def test_without_a_line_or_a_text_nothing_is_quoted():
    assert quoted(CostProgram("def state_cost(self):\n    return norm(self.ee_pos)", SCHEMA), 0) == ""
    assert quoted(object(), 2) == ""
