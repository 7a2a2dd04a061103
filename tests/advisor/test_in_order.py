import asyncio
import json

import numpy as np
import pytest
from pydantic import BaseModel

from coral.advisor.attribution import source_of
from coral.advisor.in_order import InOrderAdvisor
from coral.advisor.question import AdvisorUnavailable, BadAnswer, Question, Rejection
from coral.advisor.registry import make_advisor
from coral.advisor.replay import ReplayAdvisor
from coral.errors import InputError


class Pick(BaseModel):
    index: int


def line(kind, answer, verdict="accepted", code="", asked=0.0, answered=2.0):
    return {
        "kind": kind,
        "prompt_version": "1",
        "schema": "s",
        "pictures": ["of another question"],
        "facts_digest": "",
        "prompt_digest": "p",
        "asked_at_s": asked,
        "answered_at_s": answered,
        "verdict": verdict,
        "code": code,
        "reason": "as it was",
        "raw": json.dumps(answer),
        "answer": answer,
        "usage": {"input_tokens": 3},
        "final": False,
    }


@pytest.fixture
def recording(tmp_path):
    lines = [
        line("pick", {"index": 1}, "rejected", "low"),
        line("place", {"index": 7}),
        line("pick", None, "withdrawn"),
        line("pick", None, "unavailable", "deadline"),
        line("pick", {"index": 2}),
        line("pick", None, "malformed", "not-json"),
        line("pick", {"other": 2}),
    ]
    path = tmp_path / "attempts.jsonl"
    path.write_text("".join(json.dumps(one) + "\n" for one in lines))
    return path


def ask(advisor, kind="pick"):
    question = Question(kind=kind, prompt="asked nowhere before", answer_type=Pick, facts={})

    async def one():
        return await advisor.answer(question, [Rejection(code="low", reason="too low")])

    return asyncio.run(one())


def test_answers_come_in_their_order_kind_by_kind_whatever_is_asked(recording):
    advisor = InOrderAdvisor(recording.parent)
    first = ask(advisor)
    assert (first.value.index, first.latency_s, first.usage.input_tokens) == (1, 2.0, 3)
    assert ask(advisor).value.index == 2  # what was withdrawn or too late is left out
    with pytest.raises(BadAnswer):
        ask(advisor)
    assert ask(advisor, "place").value.index == 7
    with pytest.raises(AdvisorUnavailable, match="no longer validates"):
        ask(advisor)
    with pytest.raises(AdvisorUnavailable, match="no answer to a pick question is left") as gone:
        ask(advisor)
    assert (gone.value.code, gone.value.final) == ("not-recorded", True)


def test_it_is_a_recording_and_says_which(recording):
    advisor = make_advisor(f"in-order:{recording}", rules={}, rng=np.random.default_rng(0))
    assert (advisor.name, source_of(advisor)) == (f"in-order:{recording}", "recording")


def test_a_shipped_recording_goes_by_its_name_unless_a_file_has_it(tmp_path, monkeypatch, recording):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(AdvisorUnavailable, match=r"recordings/reef-o2.jsonl: .* no longer validates"):
        ask(InOrderAdvisor("reef-o2"), "reef-waypoint")
    (tmp_path / "reef-o2").write_bytes(recording.read_bytes())
    assert ask(InOrderAdvisor("reef-o2")).value.index == 1


def test_a_name_that_nothing_has_is_refused_with_those_that_there_are():
    for advisor in (InOrderAdvisor, ReplayAdvisor):
        with pytest.raises(InputError, match=r"contact-flip-wall, .*reef-s1"):
            advisor("reef-o9")
