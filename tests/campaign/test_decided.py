import json

from coral.campaign.columns import Group
from coral.campaign.decided import decided_table, mark_notes, share


def row(advisor, fallback, policy="rules", **more):
    return {
        "decided_by": json.dumps({"advisor": advisor, "memory": 0, "recording": 0, "fallback": fallback}),
        "answers": json.dumps({"accepted": advisor, "refused": 1, "malformed": 0, "missing": 4 * fallback}),
        "tokens_in": 100,
        "tokens_out": 10,
        "cost_usd": None,
        "thinking_s": 20.0,
        "world": "l1",
        "seed": advisor,
        "fallback": policy,
        **more,
    }


def test_the_mark_is_explained():
    assert mark_notes([row(5, 0)]) == ()
    (note,) = mark_notes([row(5, 0), row(4, 1)])
    assert note.startswith("§: 1 of 10 decisions were made by the fallback’s rules")
    (note,) = mark_notes([row(0, 3, "hold")])
    assert note.startswith("§: 3 of 3 decisions were left undecided by the advisor")


def test_shares_are_of_the_decisions_of_an_episode():
    assert share("fallback").of(row(3, 1)) == 25.0
    assert share("advisor").of(row(0, 0)) is None


def test_the_table_has_who_decided_what_came_back_and_what_it_cost():
    table = decided_table([Group("full", [row(5, 0), row(3, 2)])], "c", (), runs="missions")
    assert dict(zip(table.header, table.rows[0], strict=True)) == {
        "variant": "full §",
        "missions": "2",
        "decisions": "10",
        "by advisor": "8 (80 %)",
        "by fallback": "2 (20 %)",
        "accepted": "4.0",
        "refused": "1.0",
        "malformed": "0.0",
        "missing": "4.0",
        "tokens in": "100",
        "tokens out": "10",
        "cost (USD)": "—",
        "thinking (s)": "20.0",
    }


def test_memory_and_recordings_have_a_column_where_they_decided():
    one = row(0, 0, decided_by={"advisor": 0, "memory": 1, "recording": 0, "fallback": 0})
    table = decided_table([Group("full", [one])], "c", (), runs="trials")
    assert table.header[3:6] == ("by advisor", "by memory", "by fallback")
