import asyncio

import pytest

from coral.advisor.question import AdvisorUnavailable, BadAnswer, Reply, Usage
from coral.exam.asking import ask, ask_all
from coral.exam.item import ExamItem
from coral.reef.decide.answers import CentroidChoice

BAD = BadAnswer("not-json", "no JSON in it", raw="I am sorry", usage=Usage(output_tokens=4))


def item(number):
    return ExamItem(
        id=f"q{number}", kind="reef-centroid", group="w", prompt=str(number), prompt_version="1", facts={}, key={}
    )


class Student:
    """Answers with the number of the question, or fails as it is told to."""

    name = "student"

    def __init__(self, failures=None, latency_s=None):
        self.failures, self.latency_s = failures or {}, latency_s
        self.asked, self.closed, self.open, self.most_open = [], False, 0, 0

    async def answer(self, question, rejections):
        assert rejections == ()
        assert not self.closed
        self.asked.append(question.prompt)
        self.open += 1
        self.most_open = max(self.most_open, self.open)
        await asyncio.sleep(0)
        self.open -= 1
        if question.prompt in self.failures:
            raise self.failures[question.prompt]
        answer = CentroidChoice(selected_centroid_index=int(question.prompt))
        return Reply(value=answer, raw="{}", latency_s=self.latency_s, usage=Usage(input_tokens=9))

    async def aclose(self):
        self.closed = True


def test_every_question_is_asked_once_and_answered_in_order():
    student = Student()
    sheets = ask_all(student, [item(k) for k in range(5)])
    assert [sheet.answer.selected_centroid_index for sheet in sheets] == list(range(5))
    assert student.asked == list("01234")
    assert {sheet.usage.input_tokens for sheet in sheets} == {9}


@pytest.mark.parametrize("at_once", [1, 3])
def test_no_more_questions_are_open_than_allowed(at_once):
    student = Student()
    sheets = ask_all(student, [item(k) for k in range(7)], at_once)
    assert student.most_open == at_once
    assert [sheet.item.id for sheet in sheets] == [f"q{k}" for k in range(7)]


def test_a_reply_that_is_no_answer_is_kept_with_its_reason_and_not_asked_again():
    student = Student({"1": BAD})
    sheet = ask_all(student, [item(1)])[0]
    assert (sheet.answer, sheet.raw, sheet.failure) == (None, "I am sorry", "not-json: no JSON in it")
    assert sheet.usage.output_tokens == 4
    assert student.asked == ["1"]


def test_one_that_is_not_answered_leaves_the_others():
    gone = AdvisorUnavailable("no-network", "there is none", usage=Usage(cost_usd=0.5), final=True)
    first, second = ask_all(Student({"1": gone}), [item(1), item(2)])
    assert (first.answer, first.failure, first.seconds) == (None, "no-network: there is none", None)
    assert first.usage.cost_usd == 0.5
    assert second.answer.selected_centroid_index == 2


def test_the_time_is_what_a_recording_says_or_else_what_passed():
    assert asyncio.run(ask(Student(latency_s=4.5), item(1))).seconds == 4.5
    assert asyncio.run(ask(Student(), item(1))).seconds >= 0.0


def test_the_advisor_is_closed_at_the_end_even_after_a_fault():
    well, faulty = Student(), Student({"1": ZeroDivisionError("no")})
    ask_all(well, [item(1)])
    assert ask_all(faulty, [item(1)])[0].failure == "advisor-error: ZeroDivisionError: no"
    assert well.closed
    assert faulty.closed
