import dataclasses

import pytest

from coral.advisor.consult import BudgetCfg
from coral.advisor.model_cfg import ModelCfg
from coral.advisor.models import ModelAdvisor
from coral.advisor.registry import rules_alone
from coral.contact.episode.variants import AdvisorSetup, make_strategist
from coral.contact.tasks import load_task
from coral.contact.thinker.think_cfg import DESK_S
from coral.contact.thinker.thinker import Thinker

SERVER = "local:http://127.0.0.1:1/v1#m"


def thinker(asking: AdvisorSetup) -> Thinker:
    strategist = make_strategist("full", load_task("pick-box"), asking)
    assert isinstance(strategist, Thinker)
    return strategist


@pytest.mark.parametrize("advisor", ["heuristic", "fallible:0.3:heuristic", "fallible:0.1:fallible:0.2:heuristic"])
def test_what_rules_alone_compose_needs_no_confinement(advisor):
    assert rules_alone(advisor)


@pytest.mark.parametrize(
    "advisor",
    [
        "desk",
        "openai:heuristic",
        "replay:heuristic",
        "fallible:0.3:replay:heuristic",
        "replay:runs:heuristic",
        "local:http://127.0.0.1:1/v1#a:heuristic",
        "",
    ],
)
def test_a_name_that_ends_like_the_rules_is_still_confined(advisor):
    assert not rules_alone(advisor)


def test_a_model_is_called_as_configured():
    advisor = thinker(AdvisorSetup(advisor=SERVER, model=ModelCfg(output="tool", max_retries=7))).asker.advisor
    assert isinstance(advisor, ModelAdvisor)
    assert (advisor.cfg.output, advisor.cfg.max_retries) == ("tool", 7)


def test_a_model_has_time_and_room_to_write_and_mend_a_program():
    strategist = thinker(AdvisorSetup(advisor=SERVER))
    assert isinstance(strategist.asker.advisor, ModelAdvisor)
    assert strategist.asker.advisor.cfg.max_output_tokens >= 16_000
    assert strategist.asker.budget.deadline_s >= 3 * strategist.asker.advisor.cfg.deadline_s


def test_a_person_has_a_day_unless_told_otherwise(tmp_path):
    asking = AdvisorSetup(advisor="desk", inbox=tmp_path)
    assert thinker(asking).asker.budget.deadline_s == DESK_S
    budget = BudgetCfg(deadline_s=30.0)
    asking = dataclasses.replace(asking, think=dataclasses.replace(asking.think, budget=budget))
    assert thinker(asking).asker.budget.deadline_s == 30.0
