"""Baselines have what their papers give them, and nothing else."""

import dataclasses
import json

import pytest

from coral.advisor.rules import RuleAdvisor
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.decide.outlook import Outlook
from coral.reef.map.belief import BeliefCfg
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.variants import VARIANTS, apply_variant
from coral.reef.pictures.questions import map_scene, question_pictures

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


@pytest.mark.parametrize("variant", ["dream", "rule-based", "rule-based-dots-only", "frontier", "constant", "random"])
def test_no_rules_step_in_for_a_baseline(variant):
    def policy(fallback):
        cfg = dataclasses.replace(QUIET, pilot=dataclasses.replace(QUIET.pilot, fallback=fallback))
        return apply_variant(variant, cfg).pilot.fallback

    assert (policy("rules"), policy("hold"), policy("fail")) == ("hold", "hold", "fail")


def test_clusters_are_extracted_unless_a_variant_says_otherwise():
    assert BeliefCfg().centroids
    assert [name for name in VARIANTS if not apply_variant(name, QUIET).belief.centroids] == ["dream"]
