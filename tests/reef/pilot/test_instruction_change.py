"""What becomes of an instruction that is changed under way."""

import pytest
from beds import belief_with

from coral.errors import InputError
from coral.reef.decide.planner import InstructionCfg, PlannerCfg
from coral.reef.decide.planners import make_planner
from coral.reef.decide.trigger import Firing
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.pilot.instruction_change import InstructionChange


def planner_of(text):
    cfg = PlannerCfg(instruction=InstructionCfg(text=text))
    return make_planner(belief_with([(12.0, 10.0)]), CostFieldCfg(), lambda outlook: (), cfg)


def test_new_words_are_taken_over_once_and_told():
    planner, change, events = planner_of("Find the net."), InstructionChange(), []
    assert change.tell(planner, " Find the tyre. ", "page")
    assert planner.cfg.instruction.text == "Find the net."
    assert change.take(planner, lambda event, **fields: events.append((event, fields)))
    assert planner.cfg.instruction.text == "Find the tyre."
    assert events == [("instruction", {"text": "Find the tyre.", "by": "page"})]
    assert not change.take(planner, lambda event, **fields: events.append((event, fields)))
    assert len(events) == 1


def test_a_survey_without_an_instruction_has_none_to_change():
    planner, change = planner_of(""), InstructionChange()
    assert not change.tell(planner, "Find the tyre.", "page")
    assert not change.take(planner, lambda event, **fields: pytest.fail(event))


def test_no_words_are_none():
    with pytest.raises(InputError, match="some words"):
        InstructionChange().tell(planner_of("Find the net."), " ", "page")


def test_a_change_is_the_cause_of_the_question_that_it_brings_on_and_of_no_later_one():
    planner, change = planner_of("Find the net."), InstructionChange()
    distance, stuck = Firing(cause="distance", held_by=""), Firing(cause="stuck", held_by="")
    assert change.cause(distance) == distance
    change.tell(planner, "Find the tyre.", "page")
    change.take(planner, lambda event, **fields: None)
    assert change.cause(distance) == Firing(cause="instruction", held_by="")
    assert (change.cause(stuck), change.cause(None)) == (stuck, None)
    change.asked()
    assert change.cause(distance) == distance
