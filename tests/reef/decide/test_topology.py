import math

import numpy as np
import pytest
from beds import belief_with

from coral.reef.decide import topology
from coral.reef.decide.outlook import Outlook
from coral.reef.decide.survey import SurveyCfg, survey
from coral.reef.decide.topology import Place, frontier_worth, plan_tour, what_remains
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.world.geometry import Pose


@pytest.fixture(autouse=True)
def _turning_takes_no_time(monkeypatch):
    monkeypatch.setattr(topology, "YAW_RATE_RAD_S", 1e6)


def tour_of(points, area=1.0, wall_m=None):
    """A tour from (10, 5) m; a wall at `wall_m` cuts off all that lies east of it."""
    belief = belief_with(points, pose=Pose(10.0, 5.0, 0.0), size=(40.0, 10.0))
    if wall_m is not None:
        belief.map.obstacle[:, round(wall_m / 0.05) : round(wall_m / 0.05) + 6] = True
    outlook = Outlook.now(belief)
    left = survey(outlook, CostFieldCfg(), 1.0, SurveyCfg())
    dots = [Place(x=t.x, y=t.y, index=t.index, worth=0.5 + area) for t in belief.tracks]
    remaining = what_remains(outlook, left, dots, CostFieldCfg())
    return plan_tour(remaining, left, outlook.arrival)


def test_a_price_is_how_much_later_the_rest_is_seen():
    # Robot at 10, beds at 12, 14 and 30, half a metre a second. Best: seen after 4, 8 and 40 s, 17.3 s on average.
    tour = tour_of([(12.0, 5.0), (14.0, 5.0), (30.0, 5.0)])
    assert tour.best.index == 0
    assert tour.best_s == pytest.approx((4 + 8 + 40) / 3, abs=0.5)
    assert tour.price_s(14.0, 5.0, 1) == pytest.approx((8 + 12 + 48) / 3 - (4 + 8 + 40) / 3, abs=0.7)
    assert tour.price_s(30.0, 5.0, 2) == pytest.approx((40 + 72 + 76) / 3 - (4 + 8 + 40) / 3, abs=1.0)


def test_a_point_on_the_way_costs_nothing_and_one_behind_its_detour():
    tour = tour_of([(14.0, 5.0), (30.0, 5.0)])
    on_the_way, behind = tour.price_s(12.0, 5.0), tour.price_s(6.0, 5.0)
    assert on_the_way == pytest.approx(0.0, abs=0.3)
    assert behind == pytest.approx(2 * 4.0 / 0.5, abs=0.7)


def test_a_point_without_a_way_has_no_price():
    assert math.isinf(tour_of([(14.0, 5.0)], wall_m=20.0).price_s(30.0, 5.0))


def test_with_nothing_left_there_is_no_tour():
    assert tour_of([]) is None


def remaining_of(points, wall=False):
    belief = belief_with(points)
    if wall:
        belief.map.obstacle[100:300, 240:244] = True
    outlook = Outlook.now(belief)
    left = survey(outlook, CostFieldCfg(), 1.0, SurveyCfg())
    dots = [Place(x=t.x, y=t.y, index=t.index, worth=1.5) for t in belief.tracks]
    return what_remains(outlook, left, dots, CostFieldCfg())


def nearer(remaining, *points):
    xs, ys = np.array(points).T
    return remaining.nearer(xs, ys, (10.0, 10.0), 0.3).tolist()


def test_the_nearest_places_have_known_ways(monkeypatch):
    monkeypatch.setattr(topology, "MOST_PLACES", 2)
    remaining = remaining_of([(12.0, 10.0), (16.0, 10.0), (3.0, 3.0)])
    assert [place.index for place in remaining.places] == [0, 1]
    np.testing.assert_array_equal(remaining.beyond, [(3.0, 3.0)])
    np.testing.assert_allclose(remaining.between_m(), [[0.0, 4.0], [4.0, 0.0]], atol=0.2)


def test_nearer_is_along_known_ways_and_straight_to_the_rest(monkeypatch):
    monkeypatch.setattr(topology, "MOST_PLACES", 1)
    remaining = remaining_of([(14.0, 10.0), (3.0, 3.0)])
    assert nearer(remaining, (11.0, 10.0), (6.0, 6.0), (6.0, 16.0)) == [True, True, False]
    behind_wall = remaining_of([(14.0, 10.0)], wall=True)
    assert behind_wall.fields[0].lookup(10.0, 10.0) > 10.0
    assert nearer(behind_wall, (10.0, 12.0), (7.0, 10.0)) == [True, False]


def test_water_beside_the_reef_promises_more_than_water_far_from_it():
    near, far = (frontier_worth(metres, 0.5) for metres in (1.0, 12.0))
    assert near > 2.0 * far > 0.0
    assert frontier_worth(1.0, 0.1) < near
