from dataclasses import replace

import pytest

from coral.exam.item import ANSWERS, ExamItem
from coral.exam.score import SCORES, score
from coral.reef.decide.answers import CentroidChoice

KEY = {"seconds": {"1": 40.0, "2": 45.0}}
ITEM = ExamItem(id="a", kind="reef-centroid", group="w", prompt="", prompt_version="1", facts={}, key=KEY)


def test_every_kind_of_question_has_a_score():
    assert set(SCORES) == set(ANSWERS)


def test_an_answer_is_scored_by_the_key_of_its_question():
    answer = CentroidChoice(selected_centroid_index=2)
    assert score(ITEM, answer).score == pytest.approx(0.5)
    assert score(replace(ITEM, key={"seconds": {"2": 45.0}}), answer).score == 1.0
