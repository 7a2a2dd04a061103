import math
from dataclasses import replace

from beds import belief_with

from coral.reef.decide.outlook import Outlook
from coral.reef.decide.route import Arrival, here
from coral.reef.world.geometry import Pose


def places(tracks):
    return [(t.x, t.y) for t in tracks]


def test_only_clusters_in_front_of_the_arrival_are_ahead():
    belief = belief_with([(14.0, 10.0), (6.0, 10.0), (10.5, 14.0)])
    assert places(Outlook.now(belief).ahead(1.0)) == [(14.0, 10.0)]
    turned = replace(here(belief), pose=Pose(10.0, 10.0, math.pi))
    assert isinstance(turned, Arrival)
    assert places(Outlook(belief, turned).ahead(1.0)) == [(6.0, 10.0)]
