import asyncio
import json
from collections import Counter

import numpy as np
import pytest
from pydantic import BaseModel, Field

from coral.advisor.question import AdvisorUnavailable, BadAnswer, Question
from coral.advisor.rules import RuleAdvisor
from coral.erring.fallible import KINDS, FallibleAdvisor, spoil_number


class Choice(BaseModel):
    selected_index: int | None
    reason: str = "because"


class Waypoint(BaseModel):
    forward_m: int = Field(ge=-6, le=6)
    left_m: int = Field(ge=-6, le=6)


FACTS = {
    "robot": {"x": 1.0, "y": 1.0, "theta": 0.0},
    "n_things": 4,
    "centroids": [
        {"index": 0, "x": 0.0, "y": 1.0},
        {"index": 1, "forward_m": 2.0},
        {"index": 2, "x": 3.0, "y": 1.0},
        {"index": 3, "forward_m": -1.0},
    ],
}
CHOICE = Question(kind="choice", prompt="", answer_type=Choice, facts=FACTS)
WAYPOINT = Question(kind="waypoint", prompt="", answer_type=Waypoint, facts=FACTS)


def make(*kinds, probability=1.0, seed=0):
    counter = iter(range(10**6))
    rules = {
        "choice": lambda facts, _: Choice(selected_index=1 + next(counter) % 2),
        "waypoint": lambda facts, _: Waypoint(forward_m=3, left_m=1),
    }
    return FallibleAdvisor(RuleAdvisor(rules), probability, np.random.default_rng(seed), kinds or KINDS)


def ask(advisor, question=CHOICE, n=1):
    async def run():
        out = []
        for _ in range(n):
            try:
                out.append((await advisor.answer(question, ())).value)
            except BadAnswer as bad:
                out.append(bad.rejection.code)
            except AdvisorUnavailable as gone:
                out.append(gone.code)
        return out

    return asyncio.run(run())


@pytest.mark.parametrize(
    ("kind", "code"),
    [
        ("malformed", "not-json"),
        ("empty", "empty"),
        ("wrong_type", "wrong-type"),
        ("refusal", "refusal"),
        ("silence", "silence"),
    ],
)
@pytest.mark.parametrize("question", [CHOICE, WAYPOINT])
def test_each_error_looks_like_a_real_one(kind, code, question):
    assert set(ask(make(kind), question, 30)) <= {code, "cut-off" if kind == "malformed" else code}


def test_stale_repeats_the_answer_before():
    assert [a.selected_index for a in ask(make("stale"), CHOICE, 4)][1:] == [1, 2, 1]


def test_rates_are_met_and_seeded():
    def errs(seed):
        return make("malformed", "empty", "refusal", probability=0.3, seed=seed)

    answers = ask(errs(5), CHOICE, 3000)
    counts = Counter({"cut-off": "not-json"}.get(a, a) if isinstance(a, str) else "good" for a in answers)
    for code in ("not-json", "empty", "refusal"):
        assert counts[code] / 3000 == pytest.approx(0.1, abs=0.025)
    assert ask(errs(5), CHOICE, 50) == answers[:50]
    assert ask(errs(6), CHOICE, 50) != answers[:50]


def test_a_question_cancelled_early_does_not_shift_the_next_error():
    def errors(cancel):
        advisor = make("empty", probability=0.5, seed=2)
        got = []

        async def run():
            for number in range(20):
                asking = advisor.answer(CHOICE, ())
                if number in cancel:
                    asking.close()
                    got.append(None)
                    continue
                try:
                    await asking
                    got.append("good")
                except BadAnswer as bad:
                    got.append(bad.rejection.code)

        asyncio.run(run())
        return got

    whole, partly = errors(()), errors((0, 5, 6))
    assert [b for b in partly if b] == [a for a, b in zip(whole, partly, strict=True) if b]


FACTS_SEEN = {"centroids": [{"index": 0}, {"index": 2, "visited": True}]}


@pytest.mark.parametrize(
    ("error", "right", "wrong"),
    [
        ("wrong_type", {"mass": 0.5}, {"mass": "two or three"}),
        ("out_of_range", {"index": 3, "reason": "near"}, {"index": 4000, "reason": "near"}),
        ("out_of_range", {"box": {"at": [0.5]}}, {"box": {"at": [1500.0]}}),
        ("backward", {"forward_m": 3, "left_m": 1}, {"forward_m": -3, "left_m": 1}),
        ("backward", {"index": 0, "sure": True}, {"index": 2, "sure": True}),
        ("backward", {"mass": 0.5}, {"mass": -1}),
        ("out_of_range", {"code": "x", "why": "y"}, {"why": "y"}),
    ],
)
def test_one_number_of_an_answer_is_spoilt(error, right, wrong):
    before = json.dumps(right)
    assert spoil_number(error, right, FACTS_SEEN, np.random.default_rng(0)) == wrong
    assert json.dumps(right) == before
