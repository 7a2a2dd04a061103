import dataclasses
import json

import numpy as np
import pytest

from coral.advisor.consult import BudgetCfg
from coral.advisor.question import AdvisorUnavailable, BadAnswer, Reply
from coral.advisor.registry import make_advisor
from coral.advisor.rules import RuleAdvisor
from coral.errors import InputError
from coral.reef.decide.answers import CentroidChoice
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.mission.metrics import compute_metrics
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.pilot.guard import GuardCfg
from reef.failing_sensors import fail
from reference import texts

QUIET = MissionCfg(
    time_limit_s=150.0, latency="fixed:3", stop_when_covered=True, record=RecordCfg(pictures=False, frames=False)
)


def run(world, folder, advisor=None, cfg=QUIET, seed=0, observers=()):
    mission = Mission(world, cfg, advisor or RuleAdvisor(REEF_RULES), folder, seed=seed)
    result = mission.run(observers)
    assert result["end_reason"].partition(":")[0] in texts.SURVEY_ENDS
    return result


def events(folder, kind):
    lines = (folder / "events.jsonl").read_text().splitlines()
    return [e for e in map(json.loads, lines) if e["event"] == kind]


@pytest.fixture(scope="module")
def finished(pond, tmp_path_factory):
    folder = tmp_path_factory.mktemp("mission") / "run"
    return run(pond, folder), folder


def test_a_small_reef_is_covered_without_touching_anything(finished):
    result, _ = finished
    assert (result["coverage"], result["collisions"], result["end_reason"]) == (1.0, 0, "coverage complete")


def test_metrics_can_be_computed_again_from_the_folder(finished):
    result, folder = finished
    stored = json.loads((folder / "metrics.json").read_text())
    assert stored == compute_metrics(folder)
    assert {k: result[k] for k in stored} == stored


def test_a_net_is_on_no_list_of_true_oysters(pond, tmp_path):
    net = {"name": "net", "kind": "ghost-net", "x": pond.start.x + 2.0, "y": pond.start.y}
    world = type(pond).model_validate(pond.model_dump() | {"things": [net]})
    result = run(world, tmp_path / "run", cfg=dataclasses.replace(QUIET, time_limit_s=3.0))
    assert result["clusters_total"] == len(pond.clusters)
    assert "net" not in [one["name"] for one in events(tmp_path / "run", "judged")[-1]["clusters"]]


def test_metrics_hold_no_wall_clock(finished):
    _, folder = finished
    assert not [k for k in json.loads((folder / "metrics.json").read_text()) if "wall" in k or k.endswith("_ms")]


def test_answers_arrive_after_the_latency_and_the_controller_goes_on(finished):
    _, folder = finished
    verdicts = events(folder, "verdict")
    assert verdicts
    assert all(v["t"] == pytest.approx(v["asked_at"] + 3.0) for v in verdicts)
    rows = (folder / "trajectory.csv").read_text().splitlines()
    assert len(rows) - 1 == json.loads((folder / "metrics.json").read_text())["steps"]


def test_the_same_seed_gives_the_same_run_and_another_seed_does_not(pond, finished, tmp_path):
    _, folder = finished
    run(pond, tmp_path / "again")
    for name in ("metrics.json", "trajectory.csv", "events.jsonl", "attempts.jsonl"):
        assert (tmp_path / "again" / name).read_bytes() == (folder / name).read_bytes()
    run(pond, tmp_path / "other", cfg=dataclasses.replace(QUIET, time_limit_s=2.0), seed=1)
    other = (tmp_path / "other" / "trajectory.csv").read_bytes()
    assert not (folder / "trajectory.csv").read_bytes().startswith(other)


def test_a_folder_with_something_in_it_is_left_alone(pond, tmp_path):
    (tmp_path / "mine.txt").write_text("keep")
    with pytest.raises(InputError, match="not empty"):
        run(pond, tmp_path)
    assert [p.name for p in tmp_path.iterdir()] == ["mine.txt"]


class Silent:
    name = "silent"

    async def answer(self, question, rejections):
        raise AdvisorUnavailable("no-network", "nothing there", final=True)


class Stubborn:
    name = "stubborn"

    async def answer(self, question, rejections):
        if question.answer_type is CentroidChoice:
            return Reply(value=CentroidChoice(selected_centroid_index=99), raw="99")
        raise BadAnswer("not-json", "no")


SHORT = dataclasses.replace(QUIET, time_limit_s=15.0)


def with_fallback(policy):
    return dataclasses.replace(SHORT, pilot=dataclasses.replace(SHORT.pilot, fallback=policy))


@pytest.mark.parametrize(("advisor", "failure"), [(Silent, "no-network"), (Stubborn, "requeries-used-up")])
def test_the_rules_take_over_when_the_advisor_fails(pond, tmp_path, advisor, failure):
    result = run(pond, tmp_path / "run", advisor(), with_fallback("rules"))
    assert result["fallbacks"] >= 1
    assert result["collisions"] == 0
    assert events(tmp_path / "run", "fallback")[0]["failure"] == failure
    goals = events(tmp_path / "run", "goal")
    assert {g["source"] for g in goals} == {"initial", "fallback"}
    assert result["decided_by"] == {"advisor": 0, "memory": 0, "recording": 0, "fallback": len(goals) - 1}
    assert result["answers"]["accepted"] == 0


def test_hold_keeps_the_goal(pond, tmp_path):
    result = run(pond, tmp_path / "run", Silent(), with_fallback("hold"))
    assert {g["source"] for g in events(tmp_path / "run", "goal")} == {"initial"}
    held = events(tmp_path / "run", "held")
    assert len(held) > 1  # it is asked again
    assert result["decided_by"]["fallback"] == result["answers"]["missing"] == len(held)


def test_fail_ends_the_mission_and_says_why(pond, tmp_path):
    result = run(pond, tmp_path / "run", Silent(), with_fallback("fail"))
    assert result["end_reason"] == "advisor failed: no-network"
    assert sum(result["decided_by"].values()) == 0


@pytest.mark.wing("coral.erring")
def test_sources_add_up_to_the_goals_that_were_adopted_or_held(pond, tmp_path):
    rng = np.random.default_rng(1)
    advisor = make_advisor("sloppy:malformed=0.8:heuristic", rules=REEF_RULES, rng=rng)
    pilot = dataclasses.replace(SHORT.pilot, budget=BudgetCfg(max_requeries=1, deadline_s=7.0))
    cfg = dataclasses.replace(SHORT, pilot=pilot, latency="fixed:3", stop_when_covered=False, time_limit_s=30.0)
    result = run(pond, tmp_path / "run", advisor, cfg)
    adopted = [g["source"] for g in events(tmp_path / "run", "goal") if g["decision"] is not None]
    assert {"advisor", "fallback"} <= set(adopted)
    assert sum(result["decided_by"].values()) == len(adopted) + len(events(tmp_path / "run", "held"))
    assert result["decided_by"]["advisor"] == adopted.count("advisor") == result["answers"]["accepted"]
    asked = sum(result["answers"].values()) + sum(v["verdict"] == "withdrawn" for v in verdicts(tmp_path / "run"))
    assert asked == len(verdicts(tmp_path / "run"))
    assert any(v.get("faults") for v in verdicts(tmp_path / "run"))


def verdicts(folder):
    return events(folder, "verdict")


class StopAt:
    def __init__(self, t):
        self.t, self.now = t, 0.0

    def tick(self, mission):
        self.now = mission.t

    def stop_requested(self):
        return "stopped by the operator" if self.now >= self.t else ""


def test_an_observer_can_stop_the_mission(pond, tmp_path):
    result = run(pond, tmp_path / "run", observers=[StopAt(2.0)])
    assert (result["end_reason"], result["steps"]) == ("stopped by the operator", 20)


def test_left_alone_the_robot_goes_on_until_nothing_is_left(pond, tmp_path):
    cfg = dataclasses.replace(QUIET, time_limit_s=400.0, stop_when_covered=False, latency="0")
    puddle = pond.model_copy(update={"size_m": (9.0, 6.0), "clusters": pond.clusters[:1], "obstacles": ()})
    result = run(puddle, tmp_path / "run", cfg=cfg)
    assert (result["end_reason"], result["coverage"]) == ("nothing left to explore", 1.0)


def test_a_mission_without_its_camera_ends_with_the_vehicle_at_the_surface(pond, tmp_path):
    pilot = dataclasses.replace(QUIET.pilot, guard=GuardCfg(surface_after_s=2.0))
    mission = Mission(pond, dataclasses.replace(QUIET, pilot=pilot), RuleAdvisor(REEF_RULES), tmp_path / "run")
    fail(mission.robot.vehicle, "blind-camera", 2.0, 102.0)
    result = mission.run()
    assert result["end_reason"].startswith("surfaced: held for 2 s: camera blind")
    assert result["sim_time_s"] == pytest.approx(4.4)
    assert result["seconds_in_state"] == {"surveying": 2.3, "holding": 2.0, "surfacing": 0.1}
    assert result["collisions"] == 0


def test_what_is_left_is_told_at_the_end(pond, tmp_path):
    cut = run(pond, tmp_path / "run", cfg=dataclasses.replace(QUIET, time_limit_s=3.0))
    (left,) = events(tmp_path / "run", "left")
    assert cut["clusters_left"] == len(left["clusters"]) > 0
    assert all(one["why"] for one in left["clusters"])


def test_with_eyes_nothing_but_what_they_see_reaches_the_pilot(pond, tmp_path):
    pytest.importorskip("onnxruntime")
    cfg = dataclasses.replace(QUIET, perception="painted", time_limit_s=0.2)
    mission = Mission(pond, cfg, RuleAdvisor(REEF_RULES), tmp_path / "run")
    mission.run()
    seen = mission.robot.seen.frame
    assert seen is not None
    assert seen.value.doubt is not None
    assert seen.value.rgb is not None
    assert (seen.value.instances == -1).all()


def test_eyes_that_do_not_exist_are_refused_before_a_folder_is_made(pond, tmp_path):
    with pytest.raises(InputError, match=r"--perception: found 'rbg'"):
        Mission(pond, dataclasses.replace(QUIET, perception="rbg"), RuleAdvisor(REEF_RULES), tmp_path / "run")
    assert not (tmp_path / "run").exists()
