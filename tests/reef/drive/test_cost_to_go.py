"""The cost-to-go that the vehicle follows: when it is renewed, and where it is computed."""

import numpy as np
import pytest

from coral.advisor.clock import SimulatedClock
from coral.reef.drive.cost_to_go import CostToGo
from coral.reef.map.belief import Belief
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.map.mapping import OccupancyMap
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Pose


@pytest.fixture
def belief():
    known = Belief(OccupancyMap((30.0, 30.0), CameraCfg()))
    known.pose, known.goal = Pose(5.0, 5.0, 0.0), (8.0, 5.0)
    return known


@pytest.fixture
def clock():
    made = SimulatedClock("fixed:1", np.random.default_rng(0))
    yield made
    made.close()


def cost_to_go_of(belief, clock, most_cells=200_000, **more):
    return CostToGo(belief, clock, CostFieldCfg(), period_s=1.0, most_cells=most_cells, prepare_s=0.3, **more)


def test_a_new_goal_has_its_cost_to_go_at_once(belief, clock):
    guide = cost_to_go_of(belief, clock)
    assert guide.update(0.0)
    assert guide.field.lookup(5.0, 5.0) == pytest.approx(3.0, abs=0.1)
    assert not guide.update(0.1)
    belief.goal = (5.0, 9.0)
    assert guide.update(0.2)
    assert guide.field.lookup(5.0, 5.0) == pytest.approx(4.0, abs=0.1)


def test_a_changed_map_renews_it_once_a_period(belief, clock):
    guide = cost_to_go_of(belief, clock)
    guide.update(0.0)
    before = guide.field
    belief.map.obstacle[90:110, 128:132] = True
    belief.map.version += 1
    assert not guide.update(0.5)
    assert guide.field is before
    assert not guide.update(1.0)  # renewed, but it leads to the same goal
    assert guide.field is not before
    assert guide.field.lookup(5.0, 5.0) > before.lookup(5.0, 5.0) + 0.1


def test_a_far_goal_is_followed_once_its_cost_to_go_has_been_computed(belief, clock):
    guide = cost_to_go_of(belief, clock, most_cells=30_000)
    guide.update(0.0)
    near = guide.field
    belief.goal = (28.0, 28.0)
    clock.advance(0.1)
    assert not guide.update(0.1)
    assert guide.field is near
    for t in (0.2, 0.3):
        clock.advance(t)
        assert not guide.update(t)
    clock.advance(0.4)
    assert guide.update(0.4)
    assert guide.field.goal == (28.0, 28.0)


def test_a_far_goal_that_has_been_replaced_meanwhile_is_not_followed(belief, clock):
    guide = cost_to_go_of(belief, clock, most_cells=30_000)
    guide.update(0.0)
    belief.goal = (28.0, 28.0)
    guide.update(0.1)
    belief.goal = (5.0, 8.0)
    guide.update(0.2)
    clock.advance(1.0)
    guide.update(1.0)
    assert guide.field.goal == (5.0, 8.0)


def test_the_map_of_a_far_cost_to_go_is_that_of_the_moment_it_was_asked_for(belief, clock):
    guide = cost_to_go_of(belief, clock, most_cells=30_000)
    guide.update(0.0)
    belief.goal = (28.0, 28.0)
    guide.update(0.1)
    belief.map.obstacle[:, 300:310] = True  # a wall, seen too late
    clock.advance(0.5)
    guide.update(0.5)
    assert guide.field.goal == (28.0, 28.0)
    assert guide.field.ok


def test_a_straight_one_leads_through_what_lies_between(belief, clock):
    belief.map.obstacle[60:140, 126:130] = True
    around, straight = cost_to_go_of(belief, clock), cost_to_go_of(belief, clock, straight=True)
    around.update(0.0)
    assert straight.update(0.0)
    assert around.field.lookup(5.0, 5.0) > 3.5
    assert straight.field.lookup(5.0, 5.0) == pytest.approx(3.0, abs=0.05)
    assert not straight.update(1.0)
    belief.goal = (6.4, 5.0)  # inside the obstacle
    assert straight.update(1.1)
    assert straight.field.ok
