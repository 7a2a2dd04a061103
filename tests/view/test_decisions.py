import dataclasses

import pytest

from coral.view.decisions import Try, chain_at, decisions
from coral.view.run import RunFolder


def test_decisions_tell_cause_tries_and_goal(finished):
    first, second, third = decisions(RunFolder.read(finished))
    assert (first.cause, first.mode, first.outcome, first.goal) == ("first", "waypoint", "accepted", (6.0, 6.0))
    assert first.tries[0].said == "4 m ahead, 1 m right"
    assert first.tries[0].latency_s == 4.0
    assert [name for name, _ in first.tries[0].pictures] == ["map", "segmentation", "depth"]
    assert second.cause == "distance"
    assert [one.verdict for one in second.tries] == ["malformed", "rejected", "accepted"]
    assert second.tries[1].reason == "The chosen centroid is behind the robot."
    assert second.tries[2].said == "centroid 1"
    assert second.goal == (9.0, 9.0)
    assert [c["index"] for c in chain_at(RunFolder.read(finished), second.t)] == [0, 1]
    assert second.x == pytest.approx(2.0 + 0.18 * 12.0, abs=0.05)
    assert third.outcome == "open"
    assert third.tries[0].latency_s is None


@pytest.mark.parametrize(
    ("answer", "verdict", "said"),
    [
        ({"selected_centroid_index": 4, "reason": "near"}, "accepted", "centroid 4"),
        ({"selected_centroid_index": None}, "accepted", "no centroid"),
        ({"selected_centroid_index": None, "waypoint": {"forward_m": 2, "left_m": 0}}, "accepted", "2 m ahead"),
        (
            {"selected_centroid_index": None, "look": {"dot": 3, "side": "left", "distance_m": 2.0}},
            "accepted",
            "look at 3 from 2.0 m, left side",
        ),
        ({"selected_centroid_index": None, "done": True, "answer": "two"}, "accepted", "done: two"),
        ({"selected_centroid_index": None, "home": True, "done": False}, "accepted", "back to the start"),
        ({"forward_m": -2, "left_m": 3}, "accepted", "2 m behind, 3 m left"),
        ({"forward_m": 0, "left_m": -1}, "rejected", "1 m right"),
        ({"forward_m": 0, "left_m": 0}, "rejected", "stay here"),
        ({"mass_kg": 2, "reasoning": "heavy", "more": [1]}, "accepted", "mass kg 2"),
        ({}, "malformed", "not a valid answer"),
        ({}, "open", "still open at the end"),
        ({}, "unavailable", "no answer"),
    ],
)
def test_an_answer_in_words(answer, verdict, said):
    one = Try(attempt=0, asked_at_s=1.0, answered_at_s=3.5, verdict=verdict, answer=answer)
    assert one.said == said
    assert one.latency_s == 2.5
    assert one.why == answer.get("reason", answer.get("reasoning", ""))


def test_a_fallback_is_told_of_the_decision_that_failed(fresh):
    with (fresh / "events.jsonl").open("a") as out:
        out.write('{"step": 390, "t": 39.0, "event": "fallback", "policy": "rules", "failure": "deadline"}\n')
    assert [one.fallback for one in decisions(RunFolder.read(fresh))] == ["", "", "rules (deadline)"]


def test_a_question_that_was_withdrawn_is_no_failure(finished):
    made = decisions(RunFolder.read(finished))
    assert [one.state for one in made] == ["good", "again", "idle"]

    def last(verdict):
        only = dataclasses.replace(made[0].tries[0], verdict=verdict)
        return dataclasses.replace(made[0], tries=(only,)).state

    assert [last(v) for v in ("withdrawn", "rejected", "unavailable")] == ["idle", "bad", "bad"]


def test_a_question_that_the_end_withdrew_was_still_open(finished):
    run = RunFolder.read(finished)
    last = [e for e in run.events if e["event"] == "verdict"][-1]
    ended = [{**last, "t": 40.0, "verdict": "withdrawn", "answer": None}, {"t": 40.0, "event": "end", "reason": ""}]
    events = (*(e for e in run.events if e is not last and e["event"] != "end"), *ended)
    found = [d for d in decisions(dataclasses.replace(run, events=events)) if d.outcome == "open"]
    assert [(d.tries[-1].answered_at_s, d.tries[-1].said) for d in found][-1] == (None, "still open at the end")


def test_the_chain_is_the_last_that_was_told_whoever_chose_the_goal(finished):
    run = RunFolder.read(finished)
    alone = {"t": 39.0, "event": "goal", "source": "tour", "centroids": [{"index": 7, "x": 1.0, "y": 2.0}]}
    run = dataclasses.replace(run, events=(*(e for e in run.events if e["t"] <= 39.0), alone))
    assert [c["index"] for c in chain_at(run, 38.9)] == [0, 1]
    assert [c["index"] for c in chain_at(run, 39.0)] == [7]
    assert chain_at(run, -1.0) == ()
