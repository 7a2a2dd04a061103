import dataclasses

from coral.advisor.consult import BudgetCfg
from coral.advisor.model_cfg import ModelCfg
from coral.advisor.models import ModelAdvisor
from coral.contact.episode.variants import REMEMBERING, AdvisorSetup, make_strategist
from coral.contact.tasks import load_task
from coral.contact.thinker.think_cfg import DESK_S
from coral.contact.thinker.thinker import Thinker

SERVER = "local:http://127.0.0.1:1/v1#m"


def thinker(asking: AdvisorSetup) -> Thinker:
    strategist = make_strategist("full", load_task("pick-box"), asking)
    assert isinstance(strategist, Thinker)
    return strategist


def test_the_paper_s_variant_asks_and_remembers_as_full_does():
    assert isinstance(make_strategist("paper", load_task("pick-box")), Thinker)
    assert "paper" in REMEMBERING


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
