import json
from types import SimpleNamespace

import numpy as np
import pytest

from coral.reef.map.mapping import FREE, OBSTACLE, TARGET, UNEXPLORED
from coral.reef.ros import survey_topics
from coral.reef.sea.operator import OperatorWords
from coral.reef.world.instruction import checked_words
from reef.ros.fake_ros import FakeNode, fake_type


def test_a_grid_has_ros_values_row_by_row():
    cells = np.array([[UNEXPLORED, FREE], [OBSTACLE, TARGET]], np.uint8)
    assert survey_topics.grid_values(cells).tolist() == [-1, 0, 100, 50]


@pytest.mark.parametrize(("service", "word"), [("start", "arm"), ("hold", "hold"), ("home", "home"), ("stop", "stop")])
def test_services_are_the_operators_words(monkeypatch, service, word):
    monkeypatch.setattr(survey_topics, "ros_type", fake_type)
    node, words = FakeNode(), OperatorWords()
    survey_topics.SurveyTopics("", words, node=node)
    answer = node.services[f"coral/{service}"](None, SimpleNamespace())
    assert answer.success
    assert words.take() == [(word, "ROS 2")]


def test_the_instruction_is_a_topic_and_another_one_changes_it(monkeypatch):
    monkeypatch.setattr(survey_topics, "ros_type", fake_type)
    node, told = FakeNode(), []
    run = SimpleNamespace(
        instruction="Find the net.", record=SimpleNamespace(listeners=[]), pose=None, end_reason="",
    )  # fmt: skip

    def instruct(words, by):
        told.append((checked_words(words), by))
        return True

    topics = survey_topics.SurveyTopics("", OperatorWords(), instruct, node)
    topics._due_s = float("inf")
    topics.tick(run)
    topics.tick(run)
    node.heard["coral/instruct"](SimpleNamespace(data="Find the tyre."))
    node.heard["coral/instruct"](SimpleNamespace(data=" "))
    run.instruction = "Find the tyre."
    topics.tick(run)
    assert told == [("Find the tyre.", "ROS 2")]
    assert [m.data for topic, m in node.sent if topic == "coral/instruction"] == ["Find the net.", "Find the tyre."]
    (refused,) = [json.loads(m.data) for topic, m in node.sent if topic == "coral/events"]
    assert (refused["event"], "some words" in refused["reason"]) == ("instruction_refused", True)


def test_a_survey_without_an_instruction_has_no_topic_to_change_it(monkeypatch):
    monkeypatch.setattr(survey_topics, "ros_type", fake_type)
    node = FakeNode()
    survey_topics.SurveyTopics("", OperatorWords(), node=node)
    assert node.heard == {}
