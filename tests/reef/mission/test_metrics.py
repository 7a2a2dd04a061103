import json

import pytest

from coral.errors import InputError
from coral.reef.mission.metrics import (
    DEFINITIONS,
    OWN_MAP,
    clusters_left,
    compute_metrics,
    metrics_of,
    seconds_in_states,
)


def row(step, x, coverage, covered, clearance=1.0):
    return {
        "step": str(step),
        "t": str(step / 10),
        "x": str(x),
        "y": "0",
        "clearance": str(clearance),
        "clusters_covered": str(covered),
        "coverage": str(coverage),
    }


EVENTS = [
    {"event": "start", "t": 0.0, "clusters_total": 4},
    {"event": "question", "t": 0.0, "attempt": 0},
    {"event": "verdict", "t": 10.0, "verdict": "rejected"},
    {"event": "question", "t": 10.0, "attempt": 1},
    {"event": "verdict", "t": 20.0, "verdict": "accepted"},
    {"event": "goal", "t": 20.0, "violates": False},
    {"event": "goal", "t": 30.0, "violates": True},
    {"event": "cluster_covered", "t": 25.0},
    {"event": "collision", "t": 26.0},
    {"event": "monitor", "t": 27.0},
    {"event": "planner_failure", "t": 27.0},
    {"event": "fallback", "t": 28.0},
    {"event": "end", "t": 40.0, "reason": "time limit"},
]


def test_counts_and_rates_by_hand():
    rows = [row(1, 0.0, 0.0, 0), row(200, 3.0, 0.25, 1, clearance=0.05), row(400, 7.0, 0.25, 1)]
    assert metrics_of(EVENTS, rows) == {
        **metrics_of(EVENTS, rows),
        "coverage": 0.25,
        "clusters_covered": 1,
        "clusters_total": 4,
        "collisions": 1,
        "advisor_calls": 2,
        "requeries": 1,
        "rejections": 1,
        "fallbacks": 1,
        "deviations": 1,
        "steps": 400,
        "sim_time_s": 40.0,
        "coverage_time_s": 25.0,
        "steps_per_percent": 16.0,
        "distance_m": 7.0,
        "min_clearance_m": 0.05,
        "planner_failures": 1,
        "end_reason": "time limit",
    }


def test_every_metric_is_defined_in_words():
    assert set(metrics_of(EVENTS, [row(1, 0.0, 0.0, 0)])) <= set(DEFINITIONS)


def test_a_killed_run_is_measured_up_to_its_last_whole_line(tmp_path):
    (tmp_path / "events.jsonl").write_text("\n".join(json.dumps(e) for e in EVENTS[:4]) + '\n{"event": "verd')
    header = "step,t,x,y,clearance,clusters_covered,coverage\n"
    (tmp_path / "trajectory.csv").write_text(header + "1,0.1,0,0,1,0,0\n2,0.2,1,0,1,0,0\n3,0.")
    metrics = compute_metrics(tmp_path)
    assert (metrics["steps"], metrics["advisor_calls"], metrics["end_reason"]) == (2, 2, "killed")


def test_a_folder_that_is_no_run_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"events\.jsonl"):
        compute_metrics(tmp_path)


def test_where_nobody_knows_the_truth_contacts_are_not_counted():
    at_sea = [{**event, "judged_by": OWN_MAP} if event["event"] == "start" else event for event in EVENTS]
    assert metrics_of(at_sea, [row(1, 0.0, 0.0, 0)])["collisions"] is None


def state(t, name):
    return {"t": t, "event": "state", "state": name}


def test_the_seconds_of_the_states_add_up_to_the_run():
    events = [state(0.5, "surveying"), state(3.0, "holding"), {"t": 4.0, "event": "question"}, state(5.0, "surveying")]
    found = seconds_in_states(events, 9.0)
    assert found == {"ready": 0.5, "surveying": 6.5, "holding": 2.0}
    assert sum(found.values()) == pytest.approx(9.0)


def test_runs_without_states_have_none():
    assert seconds_in_states([{"t": 1.0, "event": "goal"}], 5.0) == {}
    assert clusters_left([{"t": 1.0, "event": "goal"}]) is None


def test_what_is_left_is_counted_as_it_was_at_the_end():
    events = [{"t": 1.0, "event": "left", "clusters": []}, {"t": 9.0, "event": "left", "clusters": [{}, {}]}]
    assert clusters_left(events) == 2
