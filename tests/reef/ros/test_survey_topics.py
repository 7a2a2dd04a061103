from types import SimpleNamespace

import numpy as np
import pytest

from coral.reef.map.mapping import FREE, OBSTACLE, TARGET, UNEXPLORED
from coral.reef.ros import survey_topics
from coral.reef.sea.operator import OperatorWords
from reef.ros.fake_ros import FakeNode, fake_type


def test_a_grid_has_ros_values_row_by_row():
    cells = np.array([[UNEXPLORED, FREE], [OBSTACLE, TARGET]], np.uint8)
    assert survey_topics.grid_values(cells).tolist() == [-1, 0, 100, 50]


@pytest.mark.parametrize(("service", "word"), [("start", "arm"), ("hold", "hold"), ("stop", "stop")])
def test_services_are_the_operators_words(monkeypatch, service, word):
    monkeypatch.setattr(survey_topics, "ros_type", fake_type)
    node, words = FakeNode(), OperatorWords()
    survey_topics.SurveyTopics("", words, node)
    answer = node.services[f"coral/{service}"](None, SimpleNamespace())
    assert answer.success
    assert words.take() == [(word, "ROS 2")]
