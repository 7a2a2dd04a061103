import csv
from dataclasses import replace

import numpy as np
import pytest
import yaml

from coral.reef.mission.record import COLUMNS, PicturePose, RecordCfg
from coral.reef.sea.frames import LocalFrame
from coral.reef.sea.record import OWN_COLUMNS, ReefTruth, SeaRecord
from coral.reef.sea.safety import SailCfg
from coral.reef.sea.survey_file import Origin, SurveyArea
from coral.reef.simulation.simulator import ReefSimulator, SimulatorCfg
from coral.reef.vehicle.response import VehicleResponse
from coral.reef.world.geometry import Frame, Pose
from coral.reef.world.world import load_world
from coral.run_files import SurveyFiles
from coral.runs import read_events, read_rows

STATE = (0.5, 0.0, 0.1, 0.5, 0.1, float("nan"), float("nan"), 1.0)
FRAME = Frame(np.ones((2, 2), np.float32), np.zeros((2, 2), np.uint8), np.zeros((2, 2), np.int32))


def made(folder, world):
    return SeaRecord(folder, RecordCfg(), world, SimulatorCfg(), threaded=False)


@pytest.mark.parametrize(("world", "columns"), [("s1", COLUMNS), (None, OWN_COLUMNS)])
def test_a_row_has_a_value_for_every_column(tmp_path, world, columns):
    record = made(tmp_path / "run", load_world(world) if world else None)
    record.tick(
        1, 0.1, Pose(5.0, 6.0, 0.1), Pose(4.8, 6.0, 0.1), Pose(5.1, 6.0, 0.1) if world else None, STATE, (1.2, 0.5, 3)
    )
    record.close()
    with open(tmp_path / "run" / "trajectory.csv") as lines:
        header, row = list(csv.reader(lines))
    assert tuple(header) == columns
    assert len(row) == len(columns)
    found = dict(zip(header, row, strict=True))
    assert float(found["x"]) == (5.1 if world else 5.0)  # the truth where there is one
    assert (found["goal_x"], float(found["omega_cmd"])) == ("", 0.1)
    if world:
        assert float(found["est_x"]) == 5.0
    else:
        assert (float(found["clearance"]), float(found["coverage"])) == (1.2, 0.5)


def test_events_are_written_in_order_and_heard(tmp_path):
    record, heard = made(tmp_path / "run", None), []
    record.listeners.append(heard.append)
    record.event(1, 0.1, "limit", cause="leak")
    record.event(2, 0.2, "end", reason="leak")
    record.close()
    assert [event["event"] for event in read_events(tmp_path / "run" / "events.jsonl")] == ["limit", "end"]
    assert heard[0] == {"step": 1, "t": 0.1, "event": "limit", "cause": "leak"}


def test_frames_are_taken_every_two_seconds(tmp_path):
    record, asked = made(tmp_path / "run", None), []

    def cells():
        asked.append(1)
        return np.zeros((4, 4), np.uint8)

    for step in range(50):
        record.frames.offer(step, 0.1 * step, cells, FRAME)
    record.close()
    assert len(asked) == 3


def test_nothing_is_written_in_the_callers_thread(tmp_path):
    record = made(tmp_path / "run", None)
    record.event(1, 0.1, "limit")
    record.tick(1, 0.1, Pose(5.0, 6.0, 0.1), Pose(4.8, 6.0, 0.1), None, STATE, (1.2, 0.5, 3))
    assert list(read_rows(tmp_path / "run" / "trajectory.csv")) == []
    record.close()
    assert len(list(read_rows(tmp_path / "run" / "trajectory.csv"))) == 1


def test_keyframes_are_kept_twice_a_second_with_colour_and_pose(tmp_path):
    record = made(tmp_path / "run", None)
    frame = replace(FRAME, rgb=np.full((2, 2, 3), 90, np.uint8))
    for step in range(20):
        at = PicturePose(pose=Pose(0.1 * step, 2.0, 0.3), odometry=Pose(0.0, 0.0, 0.0), height_m=0.9, pitch=0.1)
        record.frames.offer(step, 0.1 * step, lambda: np.zeros((4, 4), np.uint8), frame, at)
    record.close()
    rows = list(read_rows(tmp_path / "run" / SurveyFiles.POSES))
    assert [float(row["t"]) for row in rows] == [0.0, 0.5, 1.0, 1.5]
    assert (float(rows[2]["x"]), float(rows[2]["yaw"]), float(rows[2]["pitch"])) == (1.0, 0.3, 0.1)
    assert (tmp_path / "run" / "frames" / rows[2]["rgb"]).is_file()
    assert len(list((tmp_path / "run" / "frames").glob("*_map.png"))) == 1


def headed(folder, world):
    area = SurveyArea(
        "pier",
        (9.0, 8.0),
        Pose(1, 2, 0),
        ((0, 0), (9, 0), (9, 8)),
        (("wall", ((1, 1), (2, 1), (2, 2))),),
        Origin(latitude=54.0, longitude=10.0),
    )
    record = made(folder, world)
    response = VehicleResponse.of_vehicle(SailCfg().mission.simulator.vehicle)
    record.head(area, {"world": "pier", "seed": 3}, SailCfg(depth_m=2.0), response, LocalFrame(1.0, 2.0, 0.5))
    record.close()
    return [yaml.safe_load((folder / name).read_text()) for name in ("config.yaml", "world.yaml")]


def test_the_head_has_the_whole_configuration_and_the_areas_outlines(tmp_path):
    config, world = headed(tmp_path / "run", None)
    assert (config["system"], config["world"], config["seed"], config["depth_m"]) == ("reef", "pier", 3, 2.0)
    assert config["frame"] == {"x": 1.0, "y": 2.0, "turn": 0.5}
    assert config["safety"]["on_leak"] == "surface"
    assert config["mission"]["pilot"]
    assert world["size_m"] == [9.0, 8.0]
    assert world["start"] == {"x": 1, "y": 2, "theta": 0}
    assert world["datum"] == pytest.approx([54.0 + 1.8e-5, 10.0 + 1.53e-5], abs=1e-7)
    assert world["keep_out"] == [{"name": "wall", "metres": [[1, 1], [2, 1], [2, 2]]}]


def test_a_simulated_reef_is_kept_whole(tmp_path):
    assert headed(tmp_path / "run", load_world("s1"))[1]["clusters"]


@pytest.fixture
def told():
    return []


@pytest.fixture
def truth(tmp_path, told):
    world = load_world("s1")
    truth = ReefTruth(world, SimulatorCfg(), tmp_path, lambda event, **fields: told.append((event, fields)))
    yield truth
    truth.judge.close()


def test_it_counts_what_the_simulator_counts(truth, tmp_path):
    world = load_world("s1")
    simulator = ReefSimulator(world, SimulatorCfg(), np.random.default_rng(0))
    truth.follow(0, 0.0, simulator.pose)
    for step in range(1, 150):
        simulator.act((0.5, 0.1), 0.1)
        truth.follow(step, 0.1 * step, simulator.pose)
    assert truth.judge.covered == set(np.flatnonzero(simulator.coverage.covered()).tolist())
    assert truth.clearance_m(simulator.pose) == pytest.approx(simulator.clearance_m)
    last = (tmp_path / "judge.csv").read_text().splitlines()[-1].split(",")
    assert float(last[2]) == pytest.approx(simulator.imaging.imaged, abs=1e-4)


def test_driving_through_a_rock_is_one_collision(truth, told):
    rock = truth.judge.world.obstacles[0]
    for step in range(30):
        truth.follow(step, 0.1 * step, Pose(rock.x - 1.5 + 0.1 * step, rock.y, 0.0))
    touched = [fields["obstacle"] for event, fields in told if event == "collision"]
    assert touched.count(0) == 1


def test_a_cluster_is_told_once(truth, told):
    oyster = truth.judge.world.clusters[0].oysters[0]
    for step in range(40):
        truth.follow(step, 0.1 * step, Pose(oyster.x - 2.0, oyster.y, 0.16 * step))
    names = [fields["name"] for event, fields in told if event == "cluster_covered"]
    assert truth.judge.world.clusters[0].name in names
    assert len(names) == len(set(names))
    assert truth.judge.coverage == len(names) / len(truth.judge.world.clusters)
