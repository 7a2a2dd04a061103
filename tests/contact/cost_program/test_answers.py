"""Answers of the process of the costs: strict, and nothing besides what is asked for."""

import pytest
from pydantic import ValidationError

from coral.contact.cost_program.answers import Ran, WorkerFailure


def test_an_answer_is_read_from_its_json():
    assert Ran.model_validate_json(b'{"terms": ["a"]}').terms == ["a"]


@pytest.mark.parametrize("body", [b'{"error": ["a", "b", 1.5, "c"]}', b'{"error": ["a", "b", 1, "c"], "more": 1}'])
def test_nothing_is_converted_or_passed_over(body):
    with pytest.raises(ValidationError):
        WorkerFailure.model_validate_json(body)
