"""Questions about tasks that no rule was made for: one for each task, with the trial that scores the answer."""

import pytest

from coral.contact.plan.contact_regions import RegionsAnswer
from coral.errors import InputError
from coral.exam import unseen_questions
from coral.exam.contact_scenes import trial_from_json
from coral.exam.unseen_questions import unseen_items


def test_a_task_without_a_rule_has_a_question_in_words_and_a_trial_as_its_key(monkeypatch):
    monkeypatch.setattr(unseen_questions, "unseen_tasks", lambda half: ("turn-lever",))
    [item] = unseen_items("development", 3)
    assert (item.id, item.kind, item.group) == ("cost-function-000", "cost-function", "turn-lever-3")
    assert "Turn the lever on its post" in item.prompt
    assert len(item.pictures) == 1
    trial = trial_from_json(item.key["trial"])
    assert (trial.task.name, trial.seed) == ("turn-lever", 3)
    assert trial.task.objects[0].joint is not None
    assert RegionsAnswer.model_validate(item.key["regions"]).root == {}


def test_a_half_that_there_is_not_is_refused():
    with pytest.raises(InputError, match="did you mean 'test'"):
        unseen_items("tets", 0)
