import pytest

from coral.advisor.attribution import DEFINITIONS, Attribution, source_of, spent, who_decided
from coral.advisor.consult import Attempt
from coral.advisor.fallible import FallibleAdvisor, FallibleCfg
from coral.advisor.question import Usage
from coral.advisor.replay import ReplayAdvisor
from coral.advisor.rules import RuleAdvisor


def attempt(verdict, asked=0.0, answered=2.5, **usage):
    return Attempt(
        decision=0,
        attempt=0,
        asked_at_s=asked,
        answered_at_s=answered,
        question=None,
        verdict=verdict,
        usage=Usage(**usage),
    )


def test_nothing_is_counted_before_anything_happens():
    assert Attribution().to_json() == {
        "decided_by": {"advisor": 0, "memory": 0, "recording": 0, "fallback": 0},
        "answers": {"accepted": 0, "refused": 0, "malformed": 0, "missing": 0},
        "tokens_in": 0,
        "tokens_out": 0,
        "cost_usd": 0.0,
        "thinking_s": 0.0,
    }
    assert set(DEFINITIONS) == set(Attribution().to_json())


def test_attempts_and_decisions_add_up():
    found = Attribution()
    for verdict in ("rejected", "malformed", "accepted"):
        found = found.attempted(attempt(verdict, input_tokens=100, output_tokens=10, cost_usd=0.002))
    found = found.attempted(attempt("unavailable", requests=1)).attempted(attempt("withdrawn", requests=0))
    found = found.decided("advisor").decided("fallback").decided("fallback")
    said = found.to_json()
    assert said["answers"] == {"accepted": 1, "refused": 1, "malformed": 1, "missing": 1}
    assert said["decided_by"] == {"advisor": 1, "memory": 0, "recording": 0, "fallback": 2}
    assert (said["tokens_in"], said["tokens_out"], said["cost_usd"], said["thinking_s"]) == (300, 30, 0.006, 12.5)


@pytest.mark.parametrize(
    ("verdict", "usage", "known"),
    [
        ("accepted", {"requests": 0}, (0, 0, 0.0)),  # rules: nothing was sent anywhere
        ("accepted", {"requests": 1}, (None, None, None)),  # a person, or a server that does not count
        ("accepted", {"requests": 2, "input_tokens": 9, "output_tokens": 1}, (9, 1, None)),  # no price is known
        ("malformed", {"requests": 1, "input_tokens": 9, "cost_usd": 0.1}, (9, 0, 0.1)),
        ("unavailable", {"requests": 4}, (0, 0, 0.0)),  # no reply, no bill
    ],
)
def test_what_is_not_known_is_none(verdict, usage, known):
    cost = spent(attempt(verdict, **usage))
    assert (cost.tokens_in, cost.tokens_out, cost.cost_usd) == known


def test_one_unknown_cost_makes_the_sum_unknown():
    paid = Attribution().attempted(attempt("accepted", input_tokens=5, output_tokens=5, cost_usd=0.1))
    assert paid.attempted(attempt("accepted", requests=1)).to_json()["cost_usd"] is None


def test_a_recording_keeps_its_name_inside_other_advisors(tmp_path):
    (tmp_path / "attempts.jsonl").write_text("")
    recording = ReplayAdvisor(tmp_path)
    assert source_of(recording) == "recording"
    assert source_of(FallibleAdvisor(recording, FallibleCfg(), None)) == "recording"
    assert source_of(FallibleAdvisor(RuleAdvisor({}), FallibleCfg(), None)) == "advisor"
    assert source_of(object()) == "advisor"


def said(fallback="rules", **by):
    return who_decided({"decided_by": by, "answers": {"missing": 1}}, things="goals", fallback=fallback)


def test_nothing_is_said_where_the_advisor_decided_everything():
    assert said(advisor=7, fallback_=0) == ""
    assert who_decided({}, things="goals", fallback="rules") == ""
    assert who_decided({"decided_by": {"advisor": 0}, "answers": {}}, things="goals", fallback="rules") == ""


def test_everyone_else_who_decided_is_named():
    found = {"decided_by": {"advisor": 5, "fallback": 2}, "answers": {"accepted": 5, "missing": 8}}
    assert who_decided(found, things="goals", fallback="rules") == (
        "the advisor decided 5 of 7 goals, the fallback's rules 2"
    )
    assert who_decided(found, things="goals", fallback="hold") == "the advisor decided 5 of 7 goals, nobody 2 (hold)"
    assert said(memory=1, recording=3) == "the advisor decided 0 of 4 goals, the memory 1, the recording 3"
    assert said("fail", advisor=0) == "the advisor decided nothing"
