from coral.contact.episode.attribution import attribution_of


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
    assert found.decided_by == {"advisor": 1, "memory": 1, "recording": 0, "fallback": 1}
    assert found.answers == {"accepted": 1, "refused": 0, "malformed": 1, "missing": 0}
    assert (found.tokens_in, found.tokens_out, found.cost_usd, found.thinking_s) == (18, 2, None, 3.0)


def test_experts_ask_nobody():
    found = attribution_of([{"event": "strategy", "name": "expert"}, {"event": "end", "reason": "success"}])
    assert sum(found.decided_by.values()) == sum(found.answers.values()) == 0
