"""Recordings are found, read and repeated; what is broken in them is named."""

import math

import pytest
from pydantic import BaseModel

from coral.advisor.question import AdvisorUnavailable, BadAnswer, Question
from coral.advisor.recorded_attempts import find_recording, never_came, read_attempts, repeat, shipped_recordings
from coral.errors import InputError


class Pick(BaseModel):
    index: int


QUESTION = Question(kind="pick", prompt="which?", prompt_version="1", answer_type=Pick, facts={})


def entry(**changes):
    return {
        "asked_at_s": 3.0,
        "answered_at_s": 5.5,
        "verdict": "accepted",
        "code": "",
        "reason": "",
        "raw": '{"index": 4}',
        "answer": {"index": 4},
        "usage": {"input_tokens": 7, "requests": 1, "faults": ["http-429"]},
        "final": False,
        **changes,
    }


def test_a_file_comes_before_a_shipped_recording_of_its_name(tmp_path, monkeypatch):
    name = shipped_recordings()[0]
    assert find_recording(name).is_file()
    monkeypatch.chdir(tmp_path)
    (tmp_path / name).mkdir()
    assert find_recording(name).name == "attempts.jsonl"
    assert not find_recording("nothing").exists()


def test_a_reply_is_repeated_with_its_latency_and_usage(tmp_path):
    reply = repeat(entry(), QUESTION, tmp_path)
    assert (reply.value, reply.latency_s) == (Pick(index=4), 2.5)
    assert (reply.usage.input_tokens, reply.usage.faults) == (7, ("http-429",))


def test_a_reply_that_was_no_answer_is_none_again(tmp_path):
    with pytest.raises(BadAnswer) as caught:
        repeat(entry(verdict="malformed", code="no-json", reason="no JSON in it"), QUESTION, tmp_path)
    assert caught.value.rejection.code == "no-json"


@pytest.mark.parametrize("changes", [{"verdict": "withdrawn"}, {"verdict": "unavailable", "code": "deadline"}])
def test_a_reply_that_never_came_never_comes(changes, tmp_path):
    assert never_came(entry(**changes))
    with pytest.raises(AdvisorUnavailable) as caught:
        repeat(entry(**changes), QUESTION, tmp_path)
    assert caught.value.latency_s == math.inf


def test_an_answer_that_no_longer_validates_is_named(tmp_path):
    assert not never_came(entry())
    with pytest.raises(AdvisorUnavailable, match="no longer validates"):
        repeat(entry(answer={"index": "four"}), QUESTION, tmp_path / "attempts.jsonl")


def test_a_missing_recording_names_the_shipped_ones(tmp_path):
    with pytest.raises(InputError, match=shipped_recordings()[0]):
        read_attempts(tmp_path / "none.jsonl", "--advisor")
