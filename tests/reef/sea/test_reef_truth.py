import numpy as np
import pytest

from coral.reef.sea.reef_truth import ReefTruth
from coral.reef.simulation.simulator import ReefSimulator, SimulatorCfg
from coral.reef.world.geometry import Pose
from coral.reef.world.world import load_world


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
