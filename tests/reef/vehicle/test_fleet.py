import csv
import dataclasses
import json
import math
from pathlib import Path

import numpy as np
import pytest

from coral.advisor.rules import RuleAdvisor
from coral.config import checked
from coral.errors import InputError
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.mission.metrics import DEFINITIONS, compute_metrics
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.world.world import load_world

GOLDEN = Path(__file__).parents[1] / "golden"
QUIET = MissionCfg(time_limit_s=150.0, latency="fixed:3", record=RecordCfg(pictures=False, frames=False))
LOGS = ("attempts.jsonl", "trajectory.csv", "trajectory_1.csv")


def run(world, folder, robots, **changes):
    cfg = dataclasses.replace(QUIET, robots=robots, **changes)
    mission = Mission(world, cfg, RuleAdvisor(REEF_RULES), folder, seed=0)
    return mission.run(), mission


def events(folder, kind=""):
    read = map(json.loads, (folder / "events.jsonl").read_text().splitlines())
    return [e for e in read if not kind or e["event"] == kind]


def positions(folder, name):
    with open(folder / name, newline="") as lines:
        return np.array([(float(row["x"]), float(row["y"])) for row in csv.DictReader(lines)])


@pytest.fixture(scope="module")
def pair(pond, tmp_path_factory):
    folder = tmp_path_factory.mktemp("fleet") / "run"
    return *run(pond, folder, 2), folder


def test_two_robots_cover_a_small_reef_and_touch_nothing_and_not_each_other(pair):
    result, _, folder = pair
    assert (result["coverage"], result["collisions"], result["robot_collisions"]) == (1.0, 0, 0)
    assert set(json.loads((folder / "metrics.json").read_text())) <= set(DEFINITIONS)
    between = positions(folder, "trajectory.csv") - positions(folder, "trajectory_1.csv")
    gap = np.linalg.norm(between, axis=1).min() - 0.6
    assert result["min_separation_m"] == pytest.approx(gap, abs=1e-3)
    assert gap > 0.05


def test_the_same_seed_gives_the_same_two_robots(pond, pair, tmp_path):
    run(pond, tmp_path / "again", 2, time_limit_s=12.0)
    for name in LOGS:
        again = (tmp_path / "again" / name).read_bytes()
        assert again
        assert (pair[2] / name).read_bytes().startswith(again)


def test_both_robots_are_asked_for_themselves_and_share_one_map(pair):
    _, mission, folder = pair
    asked = events(folder, "question")
    assert {e["robot"] for e in asked} == {0, 1}
    assert len({e["decision"] for e in asked if not e["attempt"]}) == sum(not e["attempt"] for e in asked)
    first, second = mission.robots
    assert first.belief.map is second.belief.map
    assert first.belief.tracker is second.belief.tracker


def test_the_map_holds_no_robot(pair):
    _, mission, _ = pair
    # Both drove through open water, past each other's cameras: nothing was mapped where they have been.
    cells = mission.belief.map.cells()
    for robot in mission.robots:
        for x, y in robot.belief.trajectory:
            assert cells[int(y / 0.05), int(x / 0.05)] != 2


def test_figures_of_each_add_up_to_the_joint_ones(pair):
    result, _, folder = pair
    assert json.loads((folder / "metrics.json").read_text()) == compute_metrics(folder)
    each = result["per_robot"]
    assert [one["robot"] for one in each] == [0, 1] == list(range(result["robots"]))
    for key in ("advisor_calls", "requeries", "rejections", "distance_m", "path_replans"):
        assert sum(one[key] for one in each) == pytest.approx(result[key], abs=2e-3)


@pytest.mark.slow
def test_two_robots_share_a_reef(tmp_path):
    result, _ = run(load_world("s1"), tmp_path, 2, time_limit_s=115.0, latency="fixed:10", stop_when_covered=False)
    assert result["inspected"] > 0.99
    assert min(one["distance_m"] for one in result["per_robot"]) > 15.0


def test_one_robot_does_and_writes_what_was_recorded(pond, tmp_path):
    """What changes a mission shows here. Bytes agree on one machine, numbers to rounding on another."""
    run(pond, tmp_path / "run", 1, time_limit_s=20.0, stop_when_covered=True)
    assert not (tmp_path / "run" / "trajectory_1.csv").exists()
    kept_metrics = json.loads((GOLDEN / "alone.json").read_text())
    metrics = json.loads((tmp_path / "run" / "metrics.json").read_text())
    same({key: metrics[key] for key in kept_metrics}, kept_metrics)
    told = [json.loads(line) for line in (GOLDEN / "alone.jsonl").read_text().splitlines()]
    same([e for e in events(tmp_path / "run") if e["event"] not in ("judged", "state", "left")], told)
    rows = (tmp_path / "run" / "trajectory.csv").read_text().splitlines()
    kept = (GOLDEN / "alone.csv").read_text().splitlines()
    assert rows[0] == kept[0]
    for row, old in zip(rows[20::20], kept[1:], strict=True):
        same([float(v) for v in row.split(",") if v], [float(v) for v in old.split(",") if v])


def same(found, expected):
    """Keys in the same order, words alike, numbers to rounding; keys that were not recorded yet may have joined."""
    if isinstance(expected, dict):
        assert [key for key in found if key in expected] == list(expected)
        found, expected = [found[key] for key in expected], list(expected.values())
    if isinstance(expected, list):
        assert len(found) == len(expected)
        for one, other in zip(found, expected, strict=True):
            same(one, other)
    elif isinstance(expected, float):
        assert math.isclose(found, expected, rel_tol=1e-4, abs_tol=1e-4)
    else:
        assert found == expected


@pytest.mark.parametrize("robots", [0, 5, -1])
def test_no_or_too_many_robots_are_refused(robots):
    with pytest.raises(InputError, match="robots"):
        checked(dataclasses.replace(MissionCfg(), robots=robots), "--cfg")
