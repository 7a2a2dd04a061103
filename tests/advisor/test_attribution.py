import pytest

from coral.advisor.attribution import DEFINITIONS, attribution_of, source_of, spent, who_decided
from coral.advisor.consult import Attempt
from coral.advisor.question import Usage
from coral.advisor.replay import ReplayAdvisor
from coral.advisor.rules import RuleAdvisor
from coral.erring.sloppy import Rates, SloppyAdvisor


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
    assert attribution_of(()) == {
        "decided_by": {"advisor": 0, "memory": 0, "recording": 0, "fallback": 0},
        "answers": {"accepted": 0, "refused": 0, "malformed": 0, "missing": 0},
        "tokens_in": 0,
        "tokens_out": 0,
        "cost_usd": 0.0,
        "thinking_s": 0.0,
    }
    assert set(DEFINITIONS) == set(attribution_of(()))


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
    assert tuple(spent(attempt(verdict, **usage)).values()) == known


KNOWN = {"tokens_in": 10, "tokens_out": 2, "cost_usd": 0.5}
EVENTS = [
    {"event": "goal", "t": 0.0, "source": "initial", "decision": None},
    {"event": "verdict", "t": 10.0, "asked_at": 0.0, "verdict": "rejected", **KNOWN},
    {"event": "verdict", "t": 22.0, "asked_at": 10.0, "verdict": "accepted", **KNOWN},
    {"event": "goal", "t": 22.0, "source": "advisor", "decision": 0},
    {"event": "verdict", "t": 30.0, "asked_at": 25.0, "verdict": "unavailable", **dict.fromkeys(KNOWN, 0)},
    {"event": "fallback", "t": 30.0, "policy": "rules", "failure": "connection", "decision": 1},
    {"event": "goal", "t": 30.0, "source": "fallback", "decision": 1},
    {"event": "held", "t": 40.0, "source": "fallback", "decision": 2},
]


def test_goals_adopted_and_held_are_the_decisions():
    found = attribution_of(EVENTS)
    assert found["decided_by"] == {"advisor": 1, "memory": 0, "recording": 0, "fallback": 2}
    assert found["answers"] == {"accepted": 1, "refused": 1, "malformed": 0, "missing": 1}
    assert (found["tokens_in"], found["tokens_out"], found["cost_usd"], found["thinking_s"]) == (20, 4, 1.0, 27.0)


def test_events_of_older_versions_know_no_cost():
    found = attribution_of([{"event": "verdict", "t": 3.0, "verdict": "accepted"}])
    assert (*(found[name] for name in KNOWN), found["thinking_s"]) == (None, None, None, 0.0)


def test_each_decision_has_one_source_and_what_nobody_decides_is_none():
    found = attribution_of(
        [
            {
                "event": "verdict",
                "verdict": "accepted",
                "thinking_s": 2.0,
                "tokens_in": 9,
                "tokens_out": 1,
                "cost_usd": 0.1,
            },
            {"event": "beliefs", "decided": "parameters", "source": "advisor"},
            {"event": "verdict", "verdict": "malformed", "thinking_s": 1.0, "tokens_in": 9, "tokens_out": 1},
            {"event": "fallback", "decided": "plan", "source": "fallback"},
            {"event": "plan_answer", "failure": "requeries-used-up"},
            {"event": "recall", "decided": "plan", "source": "memory"},
            {"event": "beliefs", "source": "given"},
            {"event": "correction", "accepted": False},
        ]
    )
    assert found["decided_by"] == {"advisor": 1, "memory": 1, "recording": 0, "fallback": 1}
    assert found["answers"] == {"accepted": 1, "refused": 0, "malformed": 1, "missing": 0}
    assert (*(found[name] for name in KNOWN), found["thinking_s"]) == (18, 2, None, 3.0)


def test_experts_ask_nobody():
    found = attribution_of([{"event": "strategy", "name": "expert"}, {"event": "end", "reason": "success"}])
    assert sum(found["decided_by"].values()) == sum(found["answers"].values()) == 0


def test_a_recording_keeps_its_name_inside_other_advisors(tmp_path):
    (tmp_path / "attempts.jsonl").write_text("")
    recording = ReplayAdvisor(tmp_path)
    assert source_of(recording) == "recording"
    assert source_of(SloppyAdvisor(recording, Rates(), None, ())) == "recording"
    assert source_of(SloppyAdvisor(RuleAdvisor({}), Rates(), None, ())) == "advisor"
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
