"""Baselines have what their papers give them, and nothing else."""

import dataclasses
import json

import pytest

from coral.advisor.rules import RuleAdvisor
from coral.reef.decide.answers import WaypointChoice
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.decide.outlook import Outlook
from coral.reef.map.belief import Belief, BeliefCfg
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.map.mapping import OccupancyMap
from coral.reef.mission.assembly import make_planner
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.variants import VARIANTS, apply_variant
from coral.reef.pictures.questions import map_scene, question_pictures
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Pose

QUIET = MissionCfg(time_limit_s=20.0)


def asked(pond, folder, variant):
    """Run a mission, with the questions that were put, the belief at its end and the prompts."""
    questions = []

    class Listener(RuleAdvisor):
        async def answer(self, question, rejections):
            questions.append(question)
            return await super().answer(question, rejections)

    cfg = dataclasses.replace(apply_variant(variant, QUIET), record=dataclasses.replace(QUIET.record, report=False))
    mission = Mission(pond, cfg, Listener(REEF_RULES), folder, draw=question_pictures)
    mission.run()
    return questions, mission


def test_dream_has_no_chain_in_facts_prompt_picture_or_record(pond, tmp_path):
    questions, mission = asked(pond, tmp_path / "run", "dream")
    assert len(questions) >= 3
    for question in questions:
        assert question.kind == "reef-waypoint"
        assert question.facts["centroids"] == []
        assert "chain" not in question.prompt
        assert "orange" not in question.prompt.lower()
    scene = map_scene(Outlook.now(mission.belief))
    assert (len(scene.centroids), scene.clusters) == (0, False)
    events = [json.loads(line) for line in (tmp_path / "run" / "events.jsonl").read_text().splitlines()]
    assert all(event["centroids"] == [] for event in events if event["event"] == "question")


def test_dream_still_sees_green_on_its_map(pond, tmp_path):
    questions, mission = asked(pond, tmp_path / "run", "dream")
    assert mission.belief.map.target.any()
    assert any(frontier["reef_m"] is not None for frontier in questions[-1].facts["frontiers"])


def test_the_whole_system_is_asked_with_the_chain(pond, tmp_path):
    questions, _ = asked(pond, tmp_path / "run", "full")
    assert questions[-1].facts["centroids"]
    assert "Orange dots with numbers" in questions[-1].prompt


@pytest.mark.parametrize(
    ("variant", "codes"),
    [
        ("full", ("too-close", "blocked", "finished", "outside")),
        ("frontier", ("too-close", "blocked", "", "outside")),
        ("no-verification", ("", "", "", "outside")),
        ("dream", ("", "", "", "outside")),
    ],
)
def test_without_verification_only_points_off_the_map_are_refused(variant, codes):
    cfg = apply_variant(variant, QUIET)
    belief = Belief(OccupancyMap((20.0, 20.0), CameraCfg()), cfg.belief)
    belief.pose = Pose(15.0, 10.0, 0.0)
    belief._trail = [(15.0, 10.0)]
    belief.map.explored[:, :360] = True
    belief.map.obstacle[190:210, 370:390] = True  # 18.5 to 19.5 m, straight ahead
    planner = make_planner(belief, CostFieldCfg(), lambda outlook: (), cfg.planner)
    asked = planner.ask(planner.outlook())
    found = []
    for forward, left in ((0, 0), (4, 0), (-4, 0), (6, 0)):
        verdict = planner.verify(asked, WaypointChoice(forward_m=forward, left_m=left))
        found.append(verdict.code if verdict else "")
    assert tuple(found) == codes


@pytest.mark.parametrize("variant", ["dream", "rule-based", "rule-based-dots-only", "frontier", "lawnmower", "random"])
def test_no_rules_step_in_for_a_baseline(variant):
    def policy(fallback):
        cfg = dataclasses.replace(QUIET, pilot=dataclasses.replace(QUIET.pilot, fallback=fallback))
        return apply_variant(variant, cfg).pilot.fallback

    assert (policy("rules"), policy("hold"), policy("fail")) == ("hold", "hold", "fail")


def test_clusters_are_extracted_unless_a_variant_says_otherwise():
    assert BeliefCfg().centroids
    assert [name for name in VARIANTS if not apply_variant(name, QUIET).belief.centroids] == ["dream"]
