import time
from pathlib import Path
from types import SimpleNamespace

import pytest

from coral.commands.sail_told import TOLD, lens_told, survey_told, told


@pytest.mark.parametrize(
    ("event", "said"),
    [
        ({"event": "state", "state": "holding", "reason": "pose stale"}, "holding: pose stale"),
        ({"event": "awaited", "ends_when": "continues only on your word"}, "continues only on your word"),
        ({"event": "limit", "reason": "leak", "action": "surface"}, "limit: leak; surface"),
        ({"event": "recording_stopped", "reason": "disk full"}, "the vehicle has not: disk full"),
        ({"event": "order_refused", "order": "hold", "reason": "busy"}, "refused hold: busy"),
        (
            {"event": "place", "landmarks": 9, "recognised": 4, "x": 0.3, "y": 0.4, "theta": 0.1},
            "saved map: 4 of 9 landmarks recognised, odometry off by 0.50 m and 6 degrees",
        ),
        ({"event": "sight", "reach_m": 2.2}, "the eyes tell oysters from sea floor up to 2.2 m away"),
        ({"event": "planner_failure", "reason": "no feasible rollout"}, "stands, no feasible rollout: drive it free"),
        ({"event": "place", "landmarks": 9, "recognised": 0}, "none of 9 landmarks recognised"),
    ],
)
def test_each_event_has_its_words(event, said):
    assert event["event"] in TOLD
    assert said in told({"t": 65.0, **event})


def test_surveying_has_nothing_to_await():
    assert told({"t": 1.0, "event": "awaited", "ends_when": ""}) == ""


def test_what_happens_is_said_and_the_rest_is_not():
    said, shown, mission = [], [], SimpleNamespace(record=SimpleNamespace(listeners=[]))
    with survey_told(mission, said.append, shown.append):
        for event in ({"event": "state", "t": 3.0, "state": "holding", "reason": "x"}, {"event": "goal", "t": 3.0}):
            mission.record.listeners[0](event)
    assert [line.partition(" ")[2] for line in said] == ["holding: x"]
    assert shown == [{"event": "state", "t": 3.0, "state": "holding", "reason": "x"}]


def test_a_vehicle_without_a_way_is_told_of_once_a_minute_and_not_at_once():
    said, mission = [], SimpleNamespace(record=SimpleNamespace(listeners=[]))
    failing = [*range(50), *range(100, 200)]  # seconds; between them it drove
    with survey_told(mission, said.append):
        for t in (tick / 10.0 for second in failing for tick in range(10 * second, 10 * second + 10)):
            mission.record.listeners[0]({"event": "planner_failure", "t": t, "reason": "x"})
    assert [line.partition(" ")[0] for line in said] == ["0:20", "2:00", "3:00"]


def test_the_lens_is_checked_under_way_in_another_process():
    said, end = [], time.monotonic() + 30.0
    with lens_told(Path("run"), said.append, str, after_s=0.0):
        while not said and time.monotonic() < end:
            time.sleep(0.02)
    assert said == ["run"]


def test_a_survey_that_ends_before_has_no_check():
    said = []
    with lens_told(Path("run"), said.append, str, after_s=30.0):
        pass
    assert said == []
