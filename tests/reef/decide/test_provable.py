import numpy as np
from beds import belief_with, see

from coral.reef.decide.outlook import Outlook
from coral.reef.decide.provable import finished_dot, leads_nowhere
from coral.reef.decide.route import here
from coral.reef.decide.survey import SurveyCfg, survey
from coral.reef.decide.topology import Place, what_remains
from coral.reef.map.costfield import CostFieldCfg


def nowhere(belief, *points):
    outlook = Outlook.now(belief)
    left = survey(outlook, CostFieldCfg(), 1.0, SurveyCfg())
    dots = [Place(x=t.x, y=t.y, index=t.index, worth=1.5) for t in outlook.unvisited()]
    remaining = what_remains(outlook, left, dots, CostFieldCfg())
    return leads_nowhere(outlook, remaining, *np.array(points).T).tolist()


def test_only_what_shows_nothing_and_is_nearer_to_nothing_leads_nowhere():
    belief = belief_with([(16.0, 10.0), (4.0, 16.0)])
    points = [(12.0, 10.0), (7.0, 12.0), (10.0, 4.0), (16.0, 13.5)]
    assert nowhere(belief, *points) == [False, False, True, False]
    belief.map.explored[:100, 180:220] = False  # white water to the south
    assert nowhere(belief, *points) == [False] * 4


def test_where_nothing_is_left_nothing_is_refused():
    assert nowhere(belief_with([]), (5.0, 10.0)) == [False]


def test_a_dot_that_was_done_is_refused_and_says_why():
    belief = belief_with([(14.0, 10.0), (17.0, 10.0), (18.0, 4.0)])
    see(belief, 0)
    outlook = Outlook(belief, here(belief), closed=frozenset({1}))
    assert "seen from near" in finished_dot(outlook, 0).reason
    assert "present goal" in finished_dot(outlook, 1).reason
    assert finished_dot(outlook, 2) is None
