"""Seconds in each state."""

import pytest

from coral.reef.mission.metrics import clusters_left, seconds_in_states


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
