"""The body: speeds from the dynamics, depth with a lag, buoyancy."""

import pytest

from autopilot.body import Body, OpenWater, ReefWaters
from coral.reef.world.geometry import Pose


def moved(action, seconds, dt=0.05):
    body = Body(OpenWater(), depth_m=2.0)
    for _ in range(round(seconds / dt)):
        action(body, dt)
    return body


def test_a_quarter_of_all_thrust_ends_at_the_speed_where_drag_balances_it():
    body = moved(lambda b, dt: b.push(0.25, 0.0, 0.0, dt), 20)
    model = body.mover.vehicle.model
    u = body.velocity[0]
    assert model.du * u + model.duu * u * u == pytest.approx(0.25 * model.force_arm * model.thrust_max, rel=0.02)


def test_swimming_follows_velocities():
    body = moved(lambda b, dt: b.swim(0.4, 0.0, 0.1, dt), 10)
    assert body.velocity[0] == pytest.approx(0.4, abs=0.01)
    assert body.depth_m == pytest.approx(2.0 + 0.1 * 9.5, abs=0.02)


def test_without_thrust_it_comes_to_rest_and_rises():
    body = Body(OpenWater(), depth_m=2.0)
    for _ in range(100):
        body.swim(0.5, 0.3, 0.0, 0.05)
    for _ in range(600):
        body.coast(0.05)
    assert abs(body.velocity[0]) < 0.05
    assert abs(body.velocity[2]) < 0.01
    assert body.depth_m == 0.0


def test_a_reef_has_obstacles_that_are_counted_and_stop_it():
    waters = ReefWaters("s1")
    obstacle = waters.mover.world.obstacles[0]
    waters.vehicle.reset(Pose(obstacle.x - 1.5, obstacle.y, 0.0))
    body = Body(waters)
    for _ in range(200):
        body.swim(0.5, 0.0, 0.0, 0.05)
    assert waters.collisions == 1
    assert 0.5 < waters.distance_m < 1.5
