import math

import numpy as np
import pytest

from coral.reef.map.belief import Belief
from coral.reef.map.mapping import OccupancyMap
from coral.reef.sea.map_alignment import AlignmentCfg
from coral.reef.sea.survey_alignment import ResumeCfg, SavedMap, SurveyAlignment
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import load_world

WORLD, CFG = load_world("s1"), CameraCfg()
TRUE = Pose(WORLD.start.x, WORLD.start.y, WORLD.start.theta)
STATED = Pose(TRUE.x - 1.2, TRUE.y + 0.7, TRUE.theta - 0.3)


def look_around(origin, turns=60):
    """What a vehicle knows that turns on the spot at TRUE, and believes to be at `origin`."""
    camera, belief = Camera(Scene.from_world(WORLD), CFG), Belief(OccupancyMap(WORLD.size_m, CFG))
    for k in range(turns):
        angle = 2 * math.pi * k / turns
        picture = camera.render(Pose(TRUE.x, TRUE.y, TRUE.theta + angle))
        belief.update(picture, Pose(origin.x, origin.y, origin.theta + angle))
    return belief


@pytest.fixture(scope="module")
def dive():
    """The new dive, which believes to have begun at STATED."""
    return look_around(STATED)


@pytest.fixture
def told():
    return []


def begin(told, saved=None, **given):
    forbidden = np.zeros((round(WORLD.size_m[1] / 0.05), round(WORLD.size_m[0] / 0.05)), np.bool_)
    cfg = ResumeCfg(period_s=1.0, patience_s=10.0, alignment=AlignmentCfg(least_bodies=5, least_score=40.0))
    return SurveyAlignment(
        SavedMap(belief=saved or look_around(TRUE), cfg=cfg, **given),
        STATED,
        forbidden,
        lambda event, **fields: told.append({"event": event, **fields}),
        threaded=False,
    )


def test_the_operators_word_makes_one_map_of_both(dive, told):
    alignment = begin(told)
    for t in (0.0, 0.1):
        assert alignment.update(t, dive) is None
    assert alignment.proposal is not None
    assert "bodies match" in alignment.status
    assert [event["status"] for event in told] == ["proposed"]
    assert alignment.update(5.0, dive) is None  # nothing is used without a word
    alignment.say("align", "page")
    assert alignment.update(5.1, dive) is None  # computed by now, taken over in the next tick
    merged, shift = alignment.update(5.2, dive)
    here = shift.to_survey(STATED)
    assert here[:2] == pytest.approx(TRUE[:2], abs=0.06)
    assert here.theta == pytest.approx(TRUE.theta, abs=0.02)
    assert merged.pose == shift.to_survey(dive.pose)
    both = merged.map.cells() != look_around(TRUE).map.cells()
    assert both.mean() < 0.01  # the same reef, once
    assert (alignment.outcome, alignment.status) == ("aligned", "")
    assert told[-1]["status"] == "used"
    assert alignment.update(5.3, dive) is None


def test_a_rehearsal_needs_no_word(dive, told):
    alignment = begin(told, confirmed=True)
    found = [alignment.update(0.1 * k, dive) for k in range(5)]
    assert sum(each is not None for each in found) == 1


def test_the_operator_can_go_on_without(dive, told):
    alignment = begin(told)
    alignment.update(0.0, dive)
    alignment.say("align", "page")  # nobody has been asked yet
    alignment.say("hold", "page")
    alignment.update(0.1, dive)
    alignment.say("unaligned", "page")
    assert alignment.outcome == "refused by the operator (page)"
    assert alignment.update(0.2, dive) is None
    assert told[-1]["status"] == "unaligned"


def test_without_a_word_the_survey_goes_on_without(dive, told):
    alignment = begin(told)
    for t in (0.0, 2.0, 11.9):
        alignment.update(t, dive)
    assert not alignment.outcome
    alignment.update(12.1, dive)
    assert alignment.outcome == "no word from the operator"


def test_an_empty_map_is_told_once_and_given_up_with_its_reason(dive, told):
    alignment = begin(told, saved=Belief(OccupancyMap(WORLD.size_m, CFG)))
    for k in range(101):
        alignment.update(0.1 * k, dive)
    assert alignment.outcome.startswith("too little to compare")
    assert [event["status"] for event in told] == ["none yet", "unaligned"]


def test_a_failure_ends_the_search_and_not_the_survey(dive, told):
    class Broken(Belief):
        @property
        def map(self):
            raise OSError("no memory")

        @map.setter
        def map(self, value):
            pass

    alignment = begin(told, saved=Broken(OccupancyMap(WORLD.size_m, CFG)))
    alignment.update(0.0, dive)
    alignment.update(0.1, dive)
    assert alignment.outcome == "the alignment failed: no memory"
