import numpy as np
from beds import belief_with

from coral.reef.decide import remaining as module
from coral.reef.decide.outlook import Outlook
from coral.reef.decide.remaining import Place, frontier_worth, what_remains
from coral.reef.decide.survey import SurveyCfg, survey
from coral.reef.map.costfield import CostFieldCfg


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
    monkeypatch.setattr(module, "MOST_PLACES", 2)
    remaining = remaining_of([(12.0, 10.0), (16.0, 10.0), (3.0, 3.0)])
    assert [place.index for place in remaining.places] == [0, 1]
    np.testing.assert_array_equal(remaining.beyond, [(3.0, 3.0)])
    np.testing.assert_allclose(remaining.between_m(), [[0.0, 4.0], [4.0, 0.0]], atol=0.2)


def test_nearer_is_along_known_ways_and_straight_to_the_rest(monkeypatch):
    monkeypatch.setattr(module, "MOST_PLACES", 1)
    remaining = remaining_of([(14.0, 10.0), (3.0, 3.0)])
    assert nearer(remaining, (11.0, 10.0), (6.0, 6.0), (6.0, 16.0)) == [True, True, False]
    behind_wall = remaining_of([(14.0, 10.0)], wall=True)
    assert behind_wall.fields[0].lookup(10.0, 10.0) > 10.0
    assert nearer(behind_wall, (10.0, 12.0), (7.0, 10.0)) == [True, False]


def test_water_beside_the_reef_promises_more_than_water_far_from_it():
    near, far = (frontier_worth(metres, 0.5) for metres in (1.0, 12.0))
    assert near > 2.0 * far > 0.0
    assert frontier_worth(1.0, 0.1) < near
