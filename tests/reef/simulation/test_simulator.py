"""The simulated reef: what the vehicle touches, what it senses, and what is judged."""

import math

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.map.belief import Belief
from coral.reef.map.mapping import OccupancyMap
from coral.reef.simulation.noise import SensorNoiseCfg
from coral.reef.simulation.simulator import ReefSimulator, SimulatedVehicle, SimulatorCfg
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.vehicle.sensing import Attitude
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start

POST = Obstacle(shape="cylinder", x=6.0, y=5.0, z=0.8, size=(0.2, 0.2, 0.8))


def disc(x, y, r=0.15, name="c"):
    return Cluster(name=name, oysters=(Oyster(x=x, y=y, z=0.05, radii=(r, r, 0.05)),))


def world(*clusters, start=(5.0, 5.0, 0.0), obstacles=()):
    x, y, theta = start
    return ReefWorld(
        name="w", size_m=(20, 20), start=Start(x=x, y=y, theta=theta), clusters=clusters, obstacles=obstacles
    )


def simulator(there, **keys):
    return ReefSimulator(there, SimulatorCfg(**keys), np.random.default_rng(0))


def drive(sim, seconds):
    """Full speed ahead; return every new contact."""
    return [contact for _ in range(round(seconds / 0.1)) for contact in sim.act((0.6, 0.0), 0.1)]


def test_the_vehicle_begins_at_the_start_and_drives_on():
    sim = simulator(world(disc(15.0, 15.0), start=(2.0, 3.0, 0.5)))
    assert sim.pose == (2.0, 3.0, 0.5)
    drive(sim, 3.0)
    assert math.dist(sim.pose[:2], (2.0, 3.0)) > 1.0


def test_a_post_stops_the_hull_and_is_touched_once():
    sim = simulator(world(disc(15.0, 15.0), obstacles=(POST,)))
    ((x, y, obstacle),) = drive(sim, 5.0)
    assert obstacle == 0
    assert math.dist((x, y), (6.0, 5.0)) == pytest.approx(0.5, abs=0.02)
    assert sim.pose.x == pytest.approx(5.5, abs=0.02)
    assert sim.clearance_m == pytest.approx(0.0, abs=0.02)


def test_a_ghost_goes_through_and_is_counted_all_the_same():
    sim = simulator(world(disc(15.0, 15.0), obstacles=(POST,)), contact="ghost")
    assert [obstacle for *_, obstacle in drive(sim, 5.0)] == [0]
    assert sim.pose.x > 6.5
    assert sim.clearance_m > 0.0


def test_without_drift_the_robot_knows_where_it_is_and_how_fast():
    sim = simulator(world(disc(15.0, 15.0)))
    drive(sim, 4.0)
    sensed = sim.sense(4.0, 0.1)
    assert sensed.pose.value == sim.pose
    assert sensed.velocity.value == pytest.approx((0.6, 0.0, 0.0), abs=0.02)


def test_in_murky_water_a_mission_is_not_covered_by_what_it_could_not_see():
    """At 3 m visibility a cluster 5 m ahead counted as covered before anything could be seen of it."""
    there, shares = world(disc(6.0, 5.0, r=0.3), start=(1.0, 5.0, 0.0)), {}
    for visibility in (None, 3.0):
        sim = simulator(there, noise=SensorNoiseCfg(visibility_m=visibility))
        shares[visibility] = (sim.coverage.coverage, sim.imaging.imaged)
    assert shares == {None: (1.0, 1.0), 3.0: (0.0, 0.0)}


def test_colour_pictures_are_taken_when_asked_for():
    there = world(disc(7.0, 5.0))
    assert simulator(there).sense(0.0, 0.1).frame.value.rgb is None
    sim = simulator(there, pictures=True, camera=CameraCfg(width=80, height=60))
    first, second = (sim.sense(t, 0.1).frame.value for t in (0.0, 0.1))
    assert first.rgb.shape == (60, 80, 3)
    assert not np.array_equal(first.rgb, second.rgb)
    assert np.array_equal(first.depth, second.depth)


def test_pictures_change_nothing_that_is_measured():
    there = world(disc(7.0, 5.0))
    noise = SensorNoiseCfg(depth_sigma=0.02, drift_xy=0.02, visibility_m=4.5)
    plain, painted = (simulator(there, noise=noise, pictures=pictures).sense(0.0, 0.1) for pictures in (False, True))
    assert np.array_equal(plain.frame.value.depth, painted.frame.value.depth)
    assert plain.pose == painted.pose


def test_the_water_of_pictures_follows_the_visibility_or_is_named():
    there = world(disc(7.0, 5.0))
    murky = SensorNoiseCfg(visibility_m=3.0)
    assert simulator(there, pictures=True, noise=murky)._painter.water.name == "jerlov-5C"
    assert simulator(there, pictures=True)._painter.water.name == "jerlov-IB"
    assert simulator(there, pictures=True, water="jerlov-II")._painter.water.name == "jerlov-II"
    with pytest.raises(InputError, match=r"simulator\.water"):
        simulator(there, pictures=True, water="tap")


def test_a_rolling_and_pitching_vehicle_maps_oysters_where_they_are():
    camera, pose = CameraCfg(), Pose(5.0, 5.0, 0.0)
    there = world(disc(7.0, 5.6, r=0.15), disc(7.2, 4.2, r=0.15, name="d"))
    eye, belief = Camera(Scene.from_world(there), camera), Belief(OccupancyMap(there.size_m, camera))
    for roll, pitch in ((0.3, 0.0), (-0.25, 0.1), (0.1, -0.15), (0.0, 0.2)):
        attitude = Attitude(roll=roll, pitch=pitch, depth_m=4.0)
        belief.update(eye.render(pose, roll=roll, pitch=pitch), pose, attitude)
    found = (np.argwhere(belief.map.target)[:, ::-1] + 0.5) * 0.05
    nearest = np.min([np.hypot(*(found - at).T) for at in ((7.0, 5.6), (7.2, 4.2))], axis=0)
    assert len(found) > 20
    assert nearest.max() < 0.15 + 0.08  # the radius, and a cell and a half


def test_the_depth_of_the_water_is_the_worlds_or_the_configured_one():
    there = world(disc(15.0, 15.0))
    assert simulator(there).sense(0.0, 0.0).attitude.value.depth_m == pytest.approx(4.0)
    shallow = simulator(there.model_copy(update={"water_depth_m": 1.5})).sense(0.0, 0.0).attitude.value
    assert (shallow.depth_m, shallow.altitude_m) == (pytest.approx(0.5), 1.0)


def vehicle(told):
    sim = simulator(world(disc(8.0, 8.0), obstacles=(POST,)))
    return SimulatedVehicle(sim, 0.1, lambda event, **fields: told.append({"event": event, **fields}))


def test_everything_is_measured_at_the_tick():
    seen = vehicle([]).observe(0.7)
    assert (seen.pose.t, seen.velocity.t, seen.frame.t, seen.attitude.t) == (0.7, 0.7, 0.7, 0.7)
    assert seen.pose.value == Pose(5.0, 5.0, 0.0)


def test_a_command_moves_it_and_a_contact_is_told_once_with_the_obstacle():
    told = []
    one = vehicle(told)
    for _ in range(30):
        one.command((0.6, 0.0))
    (contact,) = told
    assert (contact["event"], contact["obstacle"]) == ("collision", 0)
    assert contact["x"] == pytest.approx(5.5, abs=0.02)
