import pytest

from coral.advisor.question import Picture
from coral.exam.item import ANSWERS, ExamItem


def item(kind="object-poses"):
    return ExamItem(
        id="object-poses-007",
        kind=kind,
        group="pick-box-1",
        prompt="Where is it?",
        prompt_version="3",
        facts={"objects": {}},
        pictures=(Picture(name="scene", png=b"x"),),
        asked_at_s=12.0,
        key={"poses": "the truth"},
    )


def test_a_question_holds_what_an_advisor_is_shown():
    question = item().question()
    assert (question.kind, question.prompt, question.prompt_version) == ("object-poses", "Where is it?", "3")
    assert (question.facts, question.asked_at_s) == ({"objects": {}}, 12.0)
    assert [picture.name for picture in question.pictures] == ["scene"]


def test_the_key_is_in_nothing_that_an_advisor_is_shown():
    assert "the truth" not in repr(item().question())
    assert "object-poses-007" not in repr(item().question())


@pytest.mark.parametrize("kind", ANSWERS)
def test_a_question_is_answered_in_the_type_of_its_kind(kind):
    assert item(kind).question().answer_type is ANSWERS[kind]
