from coral.reef.mission.attribution import attribution_of

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
    found = attribution_of(EVENTS).to_json()
    assert found["decided_by"] == {"advisor": 1, "memory": 0, "recording": 0, "fallback": 2}
    assert found["answers"] == {"accepted": 1, "refused": 1, "malformed": 0, "missing": 1}
    assert (found["tokens_in"], found["tokens_out"], found["cost_usd"], found["thinking_s"]) == (20, 4, 1.0, 27.0)


def test_events_of_older_versions_know_no_cost():
    found = attribution_of([{"event": "verdict", "t": 3.0, "verdict": "accepted"}])
    assert (found.tokens_in, found.tokens_out, found.cost_usd, found.thinking_s) == (None, None, None, 0.0)
