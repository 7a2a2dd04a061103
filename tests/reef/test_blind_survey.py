"""A mission with the sonar: its camera goes blind, and then its sonar too."""

import dataclasses
import json
import math

import pytest

from coral.advisor.rules import RuleAdvisor
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.mission.resolution import with_sonar
from coral.reef.world.find_world import find_world
from coral.runs import read_rows
from reef.failing_sensors import fail

QUIET = RecordCfg(pictures=False, frames=False, report=False)
SMALL = {"width": 96, "height": 32}


def survey(folder, seconds, *failures, **layer):
    cfg = with_sonar(MissionCfg(time_limit_s=seconds, latency="fixed:2", record=QUIET))
    simulator = dataclasses.replace(cfg.simulator, sonar=dataclasses.replace(cfg.simulator.sonar, **SMALL))
    cfg = dataclasses.replace(cfg, simulator=simulator, map=dataclasses.replace(cfg.map, **layer))
    mission = Mission(find_world("l1"), cfg, RuleAdvisor(REEF_RULES), folder)
    for failure in failures:
        fail(mission.robot.vehicle, *failure)
    result = mission.run()
    lines = (folder / "events.jsonl").read_text().splitlines()
    return mission, result, [json.loads(line) for line in lines], [*read_rows(folder / "trajectory.csv")]


def of(events, kind):
    return [event for event in events if event["event"] == kind]


def speed(row):
    return math.hypot(float(row["u"]), float(row["v"]))


def test_a_blinded_vehicle_goes_on_by_sonar_and_decides_nothing(tmp_path):
    _, result, events, rows = survey(tmp_path / "run", 13.0, ("blind-camera", 4.0, 12.0))
    assert [(e["blind"], e["t"]) for e in of(events, "blind")] == [(True, pytest.approx(4.3)), (False, 12.0)]
    assert "camera blind" in of(events, "blind")[0]["reason"]
    assert not [e for e in of(events, "question") if 4.4 < e["t"] < 12.0]
    assert [e["state"] for e in of(events, "state")] == ["surveying", "stopped"]
    assert sum(0.1 * speed(row) for row in rows if 4.4 < float(row["t"]) <= 12.0) > 1.0
    assert max(speed(row) for row in rows if 5.5 < float(row["t"]) <= 12.0) < 0.35
    assert result["collisions"] == 0


def test_without_camera_and_sonar_it_stands_within_a_second_and_says_why(tmp_path):
    _, _, events, rows = survey(tmp_path / "run", 8.0, ("blind-camera", 3.0, 7.0), ("missing-sonar", 5.0, 8.0))
    held = next(e for e in of(events, "state") if e["state"] == "holding")
    assert 5.0 < held["t"] <= 5.5
    assert "camera blind" in held["reason"]
    assert "sonar missing" in held["reason"]
    assert all(speed(row) < 0.05 for row in rows if 5.9 < float(row["t"]) <= 7.0)


@pytest.mark.parametrize("lost_s", [5.0, 5.1])  # both phases of the sonar
def test_without_both_at_cruise_speed_it_stands_within_a_second(tmp_path, lost_s):
    lost = [(name, lost_s, lost_s + 3.0) for name in ("missing-frame", "missing-sonar")]
    _, _, _, rows = survey(tmp_path / "run", lost_s + 1.3, *lost)
    assert max(speed(row) for row in rows if float(row["t"]) <= lost_s + 0.05) > 0.54
    late = [speed(row) for row in rows if float(row["t"]) >= lost_s + 0.95]
    assert late
    assert max(late) < 0.05


def test_a_silent_sonar_is_told_while_the_camera_goes_on(tmp_path):
    _, _, events, _ = survey(tmp_path / "run", 5.0, ("missing-sonar", 2.0, 4.0))
    assert [e["deaf"] for e in of(events, "deaf")] == [True, False]
    assert "holding" not in [e["state"] for e in of(events, "state")]


def test_where_the_sonar_alone_finds_obstacles_its_loss_stops_the_vehicle(tmp_path):
    mission, _, events, _ = survey(tmp_path / "run", 4.0, ("missing-sonar", 2.0, 4.0), obstacles="sonar")
    assert "sonar missing" in next(e for e in of(events, "state") if e["state"] == "holding")["reason"]
    cells = mission.belief.map
    assert (cells.obstacle == cells.layer.obstacle).all()
    assert cells.obstacle.any()
