import pytest
from beds import belief_with

from coral.reef.decide.paper_planner import PaperPlanner
from coral.reef.decide.planner import PlannerCfg
from coral.reef.decide.tour_planner import TourPlanner
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.mission.assembly import make_planner


@pytest.mark.parametrize(("algorithm", "kind"), [("tour", TourPlanner), ("paper", PaperPlanner)])
def test_the_configuration_names_the_planner(algorithm, kind):
    belief = belief_with([(14.0, 10.0)])
    made = make_planner(belief, CostFieldCfg(), lambda outlook: (), PlannerCfg(algorithm=algorithm))
    assert type(made) is kind
    asked = made.ask(made.outlook())
    belief.tracker.tracks = []  # what the robot learns meanwhile changes no question
    assert [c["index"] for c in asked.question.facts["centroids"]] == [0]
    assert asked.outlook.unvisited()
