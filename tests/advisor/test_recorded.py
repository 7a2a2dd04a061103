import asyncio

import numpy as np
import pytest
from pydantic import BaseModel

from coral.advisor.question import AdvisorUnavailable, Question
from coral.advisor.recorded import RecordedAdvisor
from coral.advisor.registry import make_advisor
from coral.errors import InputError
from coral.reef.decide.heuristic import REEF_RULES


class Anything(BaseModel):
    """Any answer."""

    model_config = {"extra": "allow"}


def ask(advisor, task, kind="cost-function", **facts):
    question = Question(kind=kind, prompt="?", answer_type=Anything, facts={"task": task, **facts})
    return asyncio.run(advisor.answer(question, ())).value.model_dump()


def test_each_task_gets_its_own_plan_once():
    advisor = RecordedAdvisor()
    assert ask(advisor, "pick-box")["stages"][0]["name"] == "above"
    assert ask(advisor, "flip-box") != ask(advisor, "flip-wall")
    with pytest.raises(AdvisorUnavailable, match="no answer to a cost-function question is left"):
        ask(advisor, "pick-box")


def test_answers_that_were_refused_then_are_left_out():
    assert ask(RecordedAdvisor(), "push-pick-board", "parameter-repair")
    with pytest.raises(AdvisorUnavailable):
        [ask(advisor, "push-pick-board", "parameter-repair") for advisor in [RecordedAdvisor()] for _ in range(2)]


def test_the_variants_unified_and_unguided_have_recordings_of_their_own():
    guided = ask(RecordedAdvisor(), "pick-box")
    unguided = RecordedAdvisor()
    assert ask(unguided, "pick-box", "physical-parameters") == ask(RecordedAdvisor(), "pick-box", "physical-parameters")
    assert ask(unguided, "pick-box", contact_strategy=False) != guided
    assert set(ask(RecordedAdvisor(), "pick-box", "unified")) >= {"parameters", "stages"}


def test_a_folder_of_the_name_of_a_recording_is_not_read(tmp_path, monkeypatch):
    (tmp_path / "contact-pick-box").mkdir()
    monkeypatch.chdir(tmp_path)
    assert ask(RecordedAdvisor(), "pick-box")["stages"]


def test_what_was_read_in_one_picture_answers_for_no_other():
    with pytest.raises(AdvisorUnavailable, match="this object-poses question was not recorded"):
        ask(RecordedAdvisor(), "pick-box", "object-poses")


@pytest.mark.parametrize(("task", "facts"), [("pull-cart", {}), ("open-door", {"contact_strategy": False})])
def test_what_nobody_answered_is_not_answered(task, facts):
    with pytest.raises(AdvisorUnavailable, match="nobody answered"):
        ask(RecordedAdvisor(), task, **facts)


def test_a_reef_has_no_recorded_advisor():
    with pytest.raises(InputError, match="in-order:reef-"):
        make_advisor("recorded", rules=REEF_RULES, rng=np.random.default_rng(0))
