import asyncio
import json

import pytest
from pydantic import BaseModel

from coral.advisor.question import Picture, Question
from coral.reef.ros import ros_advisor
from reef.ros.fake_ros import FakeNode, fake_type, message


class Answer(BaseModel):
    goal: int


def test_a_question_is_published_and_answered_by_its_id(monkeypatch):
    monkeypatch.setattr(ros_advisor, "ros_type", fake_type)
    node = FakeNode()
    advisor = ros_advisor.RosAdvisor(node=node)
    asked = Question(
        kind="goal", prompt="Where?", answer_type=Answer, facts={}, pictures=(Picture(name="map", png=b"p"),)
    )

    def hear(text):
        node.heard["coral/answer"](message(data=text))

    hear(json.dumps({"id": "another", "answer": {"goal": 1}}))
    hear("no JSON")
    hear(json.dumps({"id": "000001-goal", "answer": {"goal": 4}}))

    class Headed:
        def __init__(self, **fields):
            self.header, self.fields = message(stamp=0, frame_id=""), fields

    monkeypatch.setattr(advisor, "_image", Headed)
    reply = asyncio.run(advisor.answer(asked, ()))
    assert reply.value.goal == 4
    told = json.loads(next(m.data for topic, m in node.sent if topic == "coral/question"))
    assert (told["id"], told["prompt"], told["images"]) == ("000001-goal", "Where?", ["map"])
    assert next(m.header.frame_id for topic, m in node.sent if topic == "coral/question/pictures") == "000001-goal/map"


@pytest.mark.parametrize("text", ["", "[1]", '{"id": "a"}', "[" * 100_000, "x" * 10_000_000])
def test_what_is_no_answer_is_left(text):
    assert ros_advisor.answer_to("a", text) is None


def test_an_answer_may_be_text():
    assert ros_advisor.answer_to("a", '{"id": "a", "answer": "go to 3"}') == "go to 3"
