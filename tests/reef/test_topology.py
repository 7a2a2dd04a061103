import itertools

import numpy as np
import pytest

from coral.reef.answers import CentroidChoice
from coral.reef.belief import Belief
from coral.reef.camera import CameraCfg
from coral.reef.chain import Component
from coral.reef.costfield import CostFieldCfg
from coral.reef.geometry import Pose
from coral.reef.mapping import OccupancyMap
from coral.reef.planner import HighLevelPlanner, PlannerCfg
from coral.reef.survey import SurveyCfg, survey
from coral.reef.topology import TopologyCfg, places_left, tours_from


def test_tours_agree_with_trying_every_order():
    points = np.random.default_rng(3).uniform(0, 10, (6, 2))
    between = np.linalg.norm(points[:, None] - points[None], axis=2)
    for first, length in enumerate(tours_from(between)):
        orders = ((first, *rest) for rest in itertools.permutations([k for k in range(6) if k != first]))
        assert length == pytest.approx(min(sum(between[a, b] for a, b in itertools.pairwise(o)) for o in orders))


def test_one_place_has_nothing_to_regret():
    assert tours_from(np.zeros((1, 1))) == pytest.approx([0.0])


def corridor(points, pose=Pose(10.0, 5.0, 0.0)):  # noqa: B008
    belief = Belief(OccupancyMap((40.0, 10.0), CameraCfg()))
    belief.pose, belief._trail = pose, [(pose.x, pose.y)]
    belief.map.explored[:] = True
    belief.tracker.update([Component(x=x, y=y, area_px=200, length_m=1.0) for x, y in points])
    return belief


def places(belief, **changes):
    left = survey(belief, CostFieldCfg(), 1.0, SurveyCfg())
    return {p.index: p.regret_m for p in places_left(belief, left, CostFieldCfg(), TopologyCfg(**changes))}


def test_regret_is_the_extra_length_of_the_tour():
    # Robot at 10; places at 12, 14 and 30: 14 first means coming back for 12 (4 m more), 30 first is 16 m + 18 m.
    regret = places(corridor([(12.0, 5.0), (14.0, 5.0), (30.0, 5.0)]))
    assert regret[0] == pytest.approx(0.0, abs=0.3)
    assert regret[1] == pytest.approx(4.0 + 2.0 - 2.0, abs=0.6)
    assert regret[2] == pytest.approx(18.0, abs=1.0)


def test_without_memory_there_is_no_graph():
    assert places(corridor([(12.0, 5.0)]), enabled=False) == {}


def answer_far(belief, **topology):
    planner = HighLevelPlanner(
        belief,
        CostFieldCfg(),
        lambda kind, context: (kind, "0"),
        lambda belief: (),
        PlannerCfg(topology=TopologyCfg(**topology)),
    )
    return planner.verify(planner.observe(()), CentroidChoice(selected_centroid_index=2))


def test_a_choice_that_leads_back_is_refused_and_the_better_one_named():
    refusal = answer_far(corridor([(12.5, 5.0), (14.0, 6.0), (30.0, 5.0)]))
    assert refusal is not None
    assert refusal.code == "loop-back"
    assert refusal.details["better"] == 0


def test_the_same_choice_passes_without_the_memory():
    assert answer_far(corridor([(12.5, 5.0), (14.0, 6.0), (30.0, 5.0)]), enabled=False) is None
