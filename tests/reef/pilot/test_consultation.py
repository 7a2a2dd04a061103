"""One decision at a time: asked for, told, taken once."""

from types import SimpleNamespace

import numpy as np
import pytest
from beds import belief_with

from coral.advisor.clock import SimulatedClock
from coral.advisor.consult import BudgetCfg
from coral.advisor.question import Reply
from coral.reef.decide.answers import MissionAnswer
from coral.reef.decide.planner import InstructionCfg, PlannerCfg
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.mission.assembly import make_planner
from coral.reef.pilot.consultation import Consultation

DONE, CONTRADICTION = MissionAnswer(done=True, answer="none"), MissionAnswer()


class Says:
    """Always answers the same."""

    name = "says"

    def __init__(self, value):
        self.value = value

    async def answer(self, question, rejections):
        return Reply(value=self.value, raw="")


class Asking:
    """The consultation of a mission in words, with what it told."""

    def __init__(self, answer):
        self.events, self.attempts = [], []
        cfg = PlannerCfg(instruction=InstructionCfg(text="Find the net.", time_s=180.0))
        planner = make_planner(belief_with([(14.0, 10.0)]), CostFieldCfg(), lambda outlook: (), cfg)
        self.clock = SimulatedClock("fixed:3", np.random.default_rng(0))
        self.consultation = Consultation(
            planner, Says(answer), Says(DONE), self.clock, SimpleNamespace(field=None),
            lambda event, **fields: self.events.append((event, fields)), self.attempts.append,
            BudgetCfg(max_requeries=0), 0.0,
        )  # fmt: skip

    def told(self, event):
        return [fields for name, fields in self.events if name == event]


@pytest.fixture
def asking():
    made = []

    def make(answer):
        made.append(Asking(answer))
        return made[-1]

    yield make
    for each in made:
        each.clock.close()


def test_a_decision_is_under_way_until_its_answer_is_due_and_is_taken_once(asking):
    here = asking(DONE)
    asks = here.consultation
    assert asks.take() is None
    asks.ask()
    here.clock.advance(2.9)
    assert (asks.pending, asks.take()) == (True, None)
    here.clock.advance(3.0)
    decided = asks.take()
    assert (decided.number, decided.answer, decided.source, decided.by_rules) == (0, DONE, "advisor", False)
    assert decided.asked.question.kind == "reef-mission"
    assert (asks.pending, asks.take()) == (False, None)
    assert [fields["decision"] for fields in here.told("question")] == [0]
    assert [fields["verdict"] for fields in here.told("verdict")] == ["accepted"]
    assert len(here.attempts) == 1
    asks.ask()
    assert asks.number == 1


def test_the_rules_that_step_in_answer_at_once_and_are_no_question_to_the_advisor(asking):
    here = asking(CONTRADICTION)
    asks = here.consultation
    asks.ask()
    here.clock.advance(3.0)
    failed = asks.take()
    assert (failed.answer, failed.failure) == (None, "requeries-used-up")
    asks.ask_rules()
    decided = asks.take()
    assert (decided.number, decided.source, decided.by_rules, decided.failure) == (0, "fallback", True, "")
    assert len(here.told("question")) == len(here.attempts) == 1
