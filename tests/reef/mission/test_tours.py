"""Plans made before the dive."""

import dataclasses

import numpy as np
import pytest

from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.oracle import plan_tour
from coral.reef.mission.tours import planned
from coral.reef.mission.variants import apply_variant
from coral.reef.vehicle.vehicle import VehicleCfg, VehicleDynamics, VehicleState
from coral.reef.world.geometry import Pose
from coral.reef.world.world import Cluster, Oyster, ReefWorld, Start

CFG = MissionCfg()


@pytest.mark.parametrize("variant", ["full", "rule-based", "frontier", "lawnmower", "random", "dream"])
def test_missions_that_decide_have_no_plan(pond, variant):
    assert planned(pond, apply_variant(variant, CFG)) is None


def test_a_sweep_passes_every_lane_of_its_spacing(pond):
    commands = planned(pond, dataclasses.replace(CFG, decider="sweep", lane_m=7.0))
    vehicle = VehicleDynamics(VehicleCfg(model="kinematic"), VehicleState(*Pose(2.0, 3.0, 0.0)))
    places = np.concatenate([vehicle.step((v, omega), CFG.control_period_s) for v, omega in commands])
    for y in (3.5, 10.5):  # two lanes of 7 m in 14 m
        lane = places[np.abs(places[:, 1] - y) < 0.1]
        assert (lane[:, 0].min() < 2.0, lane[:, 0].max() > 12.0) == (True, True)


def test_the_oracle_drives_its_tour_of_the_world(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    oysters = tuple(Oyster(x=x, y=4.5, z=0.05, radii=(0.1, 0.1, 0.05)) for x in (4.4, 4.6))
    small = ReefWorld(
        name="small", size_m=(6.0, 6.0), start=Start(x=1.0, y=1.0), clusters=(Cluster(name="a", oysters=oysters),)
    )
    commands = planned(small, dataclasses.replace(CFG, decider="oracle"))
    assert len(commands)
    np.testing.assert_array_equal(commands, plan_tour(small).commands)
