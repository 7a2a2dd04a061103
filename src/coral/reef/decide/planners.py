"""The planners by name: the paper's Algorithm 2, the tour that goes beyond it, and that of missions in words."""

from __future__ import annotations

from coral.reef.decide.mission_planner import MissionPlanner
from coral.reef.decide.paper_planner import PaperPlanner
from coral.reef.decide.planner import Draw, HighLevelPlanner, PlannerCfg
from coral.reef.decide.tour_planner import TourPlanner
from coral.reef.map.belief import Belief
from coral.reef.map.costfield import CostFieldCfg

PLANNERS: dict[str, type[TourPlanner | PaperPlanner | MissionPlanner]] = {
    "tour": TourPlanner,
    "paper": PaperPlanner,
    "mission": MissionPlanner,
}


def make_planner(belief: Belief, fields: CostFieldCfg, draw: Draw, cfg: PlannerCfg | None = None) -> HighLevelPlanner:
    """Make the planner of one robot."""
    cfg = cfg or PlannerCfg()
    return PLANNERS["mission" if cfg.instruction.text else cfg.algorithm](belief, fields, draw, cfg)
