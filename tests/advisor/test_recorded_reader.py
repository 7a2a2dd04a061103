"""Answers of the recorded reader (a vision-language model at the desk), against the package as it is now."""

import dataclasses
import json
from collections import Counter
from pathlib import Path

import pytest

from coral.advisor.parse import parse_answer
from coral.advisor.recorded_attempts import SHIPPED, read_attempts, shipped_recordings
from coral.advisor.replay import ReplayAdvisor, is_recorded
from coral.contact.control.planning_world import PlanningCfg, PlanningWorld
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.episode import Episode
from coral.contact.episode.variants import AdvisorSetup, make_strategist
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.plan.plan_check import judge_plan
from coral.contact.plan.sampled_states import sample_states
from coral.contact.scene.task_names import every_task, shipped_tasks, suite_tasks
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.pose_question import PosesAnswer
from coral.contact.thinker.questions import UnifiedAnswer
from coral.contact.world_model.corrected_parameters import ParametersAnswer
from coral.contact.world_model.parameter_estimates import ParameterEstimates
from coral.contact.worlds.registry import make_world
from coral.reef.decide.answers import CentroidChoice, WaypointChoice
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.pictures.questions import question_pictures
from coral.reef.world.world import load_world

ROOT = Path(__file__).parents[2]
ANSWERS = {
    "reef-centroid": CentroidChoice,
    "reef-waypoint": WaypointChoice,
    "physical-parameters": ParameterEstimates,
    "contact-regions": RegionsAnswer,
    "object-poses": PosesAnswer,
    "parameter-repair": ParametersAnswer,
    "cost-function": PlanAnswer,
    "cost-repair": PlanAnswer,
    "unified": UnifiedAnswer,
}
NAMES = shipped_recordings()
CONTACT = {
    **{name: (name, 300) for name in shipped_tasks()},
    **{name: (name, 0) for name in suite_tasks("unseen", "development")},
    **{name: (name, 3) for name in suite_tasks("unseen", "test")},
    **{name: (name, 3000) for name in (*suite_tasks("long"), *suite_tasks("force"))},
    "pull-shelf": (str(ROOT / "tests/data/recordings/pull-shelf.yaml"), 0),
}
"""Recordings of contact tasks: task and seed of the trial for which the plan was written."""


def attempts(name):
    return read_attempts(SHIPPED / f"{name}.jsonl", name)


def test_every_recorded_answer_still_parses_to_what_it_was():
    read = Counter()
    for name in NAMES:
        for entry in attempts(name):
            if entry["verdict"] == "withdrawn":
                assert entry["answer"] is None
                read["no reply was waited for"] += 1
                continue
            now = parse_answer(entry["raw"], ANSWERS[entry["kind"]])
            assert now == ANSWERS[entry["kind"]].model_validate(entry["answer"])
            read[entry["kind"]] += 1
    assert read == {
        "reef-centroid": 47,
        "unified": 7,
        "reef-waypoint": 57,
        "physical-parameters": 40,
        "cost-function": 46,
        "contact-regions": 8,
        "parameter-repair": 14,
        "cost-repair": 10,
        "object-poses": 60,
        "no reply was waited for": 3,
    }


def test_every_shipped_task_was_answered_and_no_other():
    for task in every_task():
        kinds = {entry["kind"] for entry in attempts(f"contact-{task}") if entry["verdict"] == "accepted"}
        assert {"physical-parameters", "cost-function"} <= kinds, task
        assert is_recorded(task)
    assert not is_recorded("pull-cart")


def test_reasons_for_refusals_are_those_of_today():
    sources = [*(ROOT / "src/coral/reef").rglob("*.py"), *(ROOT / "src/coral/contact").rglob("*.py")]
    today = "".join(path.read_text(encoding="utf-8") for path in sources)
    codes = {entry["code"] for name in NAMES for entry in attempts(name) if entry["verdict"] == "rejected"}
    assert codes == {"visited", "behind-robot", "deviation", "too-close", "replay", "wrong_type"}
    assert [code for code in codes if f'"{code}"' not in today] == []


def attempted(name, folder, limit_s):
    task, seed = CONTACT[name]
    advisor = f"in-order:contact-{name}"
    task = load_task(task).model_copy(update={"time_limit_s": limit_s})
    strategist = make_strategist("full", task, AdvisorSetup(advisor=advisor, folder=folder))
    cfg = EpisodeCfg(poses="ground-truth")
    controller = dataclasses.replace(cfg.controller, mppi=dataclasses.replace(cfg.controller.mppi, samples=16))
    record = dataclasses.replace(cfg.record, states=False, report=False)
    cfg = dataclasses.replace(cfg, controller=controller, record=record)
    episode = Episode(sample_trial(task, seed), "hand", strategist, cfg, folder, variant="full", advisor=advisor)
    return episode.run()


@pytest.mark.slow
@pytest.mark.parametrize("name", CONTACT)
def test_recorded_plans_compile_and_pass_the_checks_in_their_scenes(tmp_path, name):
    metrics = attempted(name, tmp_path / "run", 0.1)
    regions = int(name in (*shipped_tasks(), "pull-shelf"))  # nobody was asked for those of the suites
    assert metrics["decided_by"] == {"advisor": 0, "memory": 0, "recording": 2 + regions, "fallback": 1 - regions}
    assert metrics["answers"] == {"accepted": 2 + regions, "refused": 0, "malformed": 0, "missing": 1 - regions}


@pytest.mark.slow
def test_a_recorded_plan_succeeds_again(tmp_path):
    metrics = attempted("flip-box", tmp_path / "run", 12.0)
    assert (metrics["success"], metrics["decided_by"]["fallback"]) == (True, 0)
    assert "advisor: in-order:contact-flip-box\n" in (tmp_path / "run/config.yaml").read_text()


def test_the_recorded_repair_passes_the_checks_in_its_scene():
    (repair,) = [entry for entry in attempts("contact-push-pick-board") if entry["kind"] == "cost-repair"]
    trial = sample_trial(load_task("push-pick-board"), 300)
    hand = make_world("hand", trial, PlanningCfg().step_s)
    first = hand.reset()
    hand.close()
    believed = {name: item.physical for name, item in trial.objects.items()}
    world = PlanningWorld(trial, believed, first, PlanningCfg())
    try:
        sizes = {name: trial.size(name) for name in trial.objects}
        samples = sample_states(world, first, sizes)
        plan = ANSWERS["cost-repair"].model_validate(repair["answer"])
        assert judge_plan(plan, world.schema, samples).refusal is None
        unknown = plan.model_copy(
            update={
                "stages": [plan.stages[0].model_copy(update={"code": "def state_cost(self):\n    return self.x\n"})]
            }
        )
        assert judge_plan(unknown, world.schema, samples).refusal is not None
    finally:
        world.close()


def test_a_recorded_mission_says_that_its_questions_have_changed(tmp_path):
    cfg = dataclasses.replace(MissionCfg(), time_limit_s=2.0, record=RecordCfg(pictures=False, frames=False))
    cfg = dataclasses.replace(cfg, pilot=dataclasses.replace(cfg.pilot, fallback="fail"))
    mission = Mission(load_world("o2"), cfg, ReplayAdvisor("reef-o2"), tmp_path / "run", seed=5, draw=question_pictures)
    assert mission.run()["end_reason"] == "advisor failed: not-recorded"
    (attempt, *_) = (tmp_path / "run/attempts.jsonl").read_text().splitlines()
    assert "prompt version" in json.loads(attempt)["reason"]
