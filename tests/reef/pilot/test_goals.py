"""How decisions become goals, and what is told of each."""

import numpy as np
import pytest
from beds import belief_with

from coral.advisor.clock import SimulatedClock
from coral.reef.decide.answers import MissionAnswer
from coral.reef.decide.planner import InstructionCfg, PlannerCfg
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.mission.assembly import make_planner
from coral.reef.pilot.consultation import Decided
from coral.reef.pilot.goals import GONE, SURVEY_ENDED, Goals
from coral.reef.pilot.pilot_cfg import PilotCfg


class Setting:
    """The goals of a mission in words, with what they told."""

    def __init__(self):
        self.belief, self.events, self.renewed = belief_with([(14.0, 10.0), (6.0, 10.0)]), [], []
        cfg = PlannerCfg(instruction=InstructionCfg(text="Find the net.", time_s=180.0))
        self.planner = make_planner(self.belief, CostFieldCfg(), lambda outlook: (), cfg)
        self.clock = SimulatedClock("fixed:3", np.random.default_rng(0))
        self.goals = Goals(
            self.belief, self.planner, self.clock, self.emit, lambda: self.renewed.append(True), PilotCfg()
        )

    def emit(self, event, **fields):
        self.events.append((event, fields))

    def decided(self, answer):
        asked = self.planner.ask(self.planner.outlook())
        return Decided(number=3, asked=asked, answer=answer, failure="", source="advisor", by_rules=False), asked


@pytest.fixture
def setting():
    made = Setting()
    yield made
    made.clock.close()


def test_a_choice_goes_behind_the_goal_that_was_under_way(setting):
    setting.goals.begin(setting.belief.pose, 0.0)
    setting.goals.adopt(*setting.decided(MissionAnswer(selected_centroid_index=0, then=(1,), reason="near")))
    (_, first), (_, second) = setting.events
    assert (first["source"], first["reason"]) == ("initial", "initial waypoint")
    assert (second["source"], second["decision"], second["index"], second["reason"]) == ("advisor", 3, 0, "near")
    assert (second["waits"], second["then"]) == (1, [1])
    assert [goal.index for goal in setting.planner.route.goals] == [None, 0, 1]
    assert setting.renewed == []


def test_a_dot_that_has_vanished_is_told_and_changes_no_goal(setting):
    decided, asked = setting.decided(MissionAnswer(selected_centroid_index=0))
    setting.planner.locate = lambda asked, answer: None
    setting.goals.adopt(decided, asked)
    assert setting.belief.last_failure == (0, GONE)
    ((event, held),) = setting.events
    assert (event, held["reason"], setting.planner.route.goals) == ("held", f"dot 0: {GONE}", ())


def test_a_mission_in_words_ends_where_the_robot_was_to_be(setting):
    setting.goals.begin(setting.belief.pose, 0.0)
    decided, asked = setting.decided(MissionAnswer(done=True, answer="none"))
    assert setting.goals.end(decided, asked, 1.0) == (asked.outlook.arrival.in_s > 0.0)
    event, held = setting.events[-1]
    assert (event, held["reason"], held["answer"]) == ("held", SURVEY_ENDED, "none")


def test_the_way_home_replaces_all_goals(setting):
    setting.goals.begin(setting.belief.pose, 0.0)
    setting.goals.go_home(4.0, 5.0, 1.0)
    (home,) = setting.planner.route.goals
    assert (home.x, home.y, setting.events[-1][1]["source"]) == (4.0, 5.0, "home")
