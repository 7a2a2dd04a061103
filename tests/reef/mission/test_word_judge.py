"""The judge of missions in words, and what such a mission changes."""

import dataclasses
import json

import pytest

from coral.advisor.rules import RuleAdvisor
from coral.errors import InputError
from coral.reef.decide.answers import Mark, MissionAnswer
from coral.reef.decide.trigger import TriggerCfg
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.variants import apply_variant
from coral.reef.mission.word_judge import INSPECT_M, instructed, with_instruction
from coral.reef.world.instruction import MissionText
from coral.reef.world.world import ReefWorld, load_world

pytestmark = pytest.mark.usefixtures("small_stills")

WORLD = ReefWorld.model_validate(
    {
        "name": "yard",
        "size_m": [14.0, 10.0],
        "start": {"x": 2.0, "y": 5.0},
        "things": [
            {"name": "tyre", "kind": "tyre", "x": 7.0, "y": 5.0},
            {"name": "net", "kind": "ghost-net", "x": 11.0, "y": 2.0},
        ],
        "mission": {
            "instruction": "Inspect the tyre, stay away from the net, and say what colour the tyre is.",
            "time_s": 60.0,
            "conditions": [
                {"kind": "inspected", "of": ["tyre"]},
                {"kind": "kept_off", "of": ["ghost-net"], "distance_m": 2.0},
                {"kind": "answered", "right": ["black"]},
            ],
        },
    }
)


def run(folder, variant="full", rules=None, margin_s=2.0, world=WORLD):
    planner = MissionCfg().planner
    planner = dataclasses.replace(planner, route=dataclasses.replace(planner.route, margin_s=margin_s))
    pilot = dataclasses.replace(MissionCfg().pilot, trigger=TriggerCfg(cooldown_s=0.0))
    cfg = apply_variant(variant, dataclasses.replace(MissionCfg(), latency="0", planner=planner, pilot=pilot))
    advisor = RuleAdvisor({"reef-mission": rules or (lambda facts, rejections: MissionAnswer(done=True))})
    return Mission(world, cfg, advisor, folder, variant=variant).run()


def test_a_reef_without_oysters_has_none_to_cover(tmp_path):
    found = run(tmp_path / "run")
    assert (found["clusters_total"], found["clusters_covered"], found["coverage"]) == (0, 0, 0.0)


def test_an_advisor_that_does_it_fulfils_the_mission(tmp_path):
    def rules(facts, rejections):
        left = sorted((dot["path_m"], dot["index"]) for dot in facts["centroids"] if dot["path_m"] is not None)
        near = [dot for dot in facts["centroids"] if dot["visited"]]
        if near:
            return MissionAnswer(done=True, answer="It is black.")
        return (
            MissionAnswer(selected_centroid_index=left[0][1])
            if left
            else MissionAnswer(waypoint={"forward_m": 2, "left_m": 0})
        )

    result = run(tmp_path / "run", rules=rules)
    assert result["success"], result["conditions"]
    assert result["answer"] == "It is black."
    assert json.loads((tmp_path / "run" / "metrics.json").read_text())["success"] is True


def test_to_end_at_once_fails_by_what_was_not_done(tmp_path):
    result = run(tmp_path / "run")
    # It ends where the initial waypoint, on which it was when asked, had led it: beside the tyre.
    assert [one["met"] for one in result["conditions"]] == [True, True, False]
    assert not result["success"]


def test_done_said_on_the_way_ends_the_mission_where_the_way_ends(tmp_path):
    def rules(facts, rejections):
        dots = [dot for dot in facts["centroids"] if dot["path_m"] is not None]
        tyre = min(dots, key=lambda dot: dot["path_m"], default={"index": 0, "visited": False})
        if tyre["visited"]:  # or will be, when the answer is needed
            return MissionAnswer(done=True, answer="black")
        return MissionAnswer(selected_centroid_index=tyre["index"])

    result = run(tmp_path / "run", rules=rules, margin_s=8.0)  # asked long before the tyre
    assert result["success"], result["conditions"]
    assert result["end_reason"] == "the advisor ended the survey"


def test_a_look_shows_a_thing_from_its_side_whatever_else_comes_into_view(tmp_path):
    def rules(facts, rejections):
        tyre = min(facts["centroids"], key=lambda dot: dot["path_m"], default=None)
        if tyre is None:
            return MissionAnswer(waypoint={"forward_m": 2, "left_m": 0})
        if not asked:
            asked.append(tyre["index"])
            return MissionAnswer(look={"dot": tyre["index"], "side": "left", "distance_m": 2.0})
        return MissionAnswer(done=True)

    asked = []
    sides = {"kind": "sides", "of": ["tyre"], "count": 2}
    text = MissionText.model_validate({"instruction": "Look.", "time_s": 90.0, "conditions": [sides]})
    result = run(tmp_path / "run", rules=rules, world=WORLD.model_copy(update={"mission": text}))
    assert result["success"], result["conditions"]


def test_the_oracle_fulfils_it(tmp_path):
    assert run(tmp_path / "run", "oracle")["success"]


def test_a_mission_sets_time_and_distance_and_other_worlds_change_nothing():
    cfg = instructed(MissionCfg(), WORLD.mission)
    assert (cfg.time_limit_s, cfg.planner.instruction.time_s) == (60.0, 60.0)
    assert cfg.belief.inspect.pixel_m * cfg.simulator.camera.intrinsics[0] == pytest.approx(INSPECT_M)
    assert instructed(MissionCfg(), load_world("s1").mission) == MissionCfg()


def test_words_of_ones_own_replace_those_of_the_world():
    cfg = with_instruction(MissionCfg(), "Look at the wheel.", WORLD.mission)
    assert instructed(cfg, WORLD.mission).planner.instruction.text == "Look at the wheel."
    assert with_instruction(MissionCfg(), "Find it.").planner.instruction.time_s == MissionCfg().time_limit_s
    with pytest.raises(InputError, match="--instruction"):
        with_instruction(MissionCfg(), " ")


def changing(folder, words):
    """A mission whose instruction is changed at its second question."""

    def rules(facts, rejections):
        told.append(facts["mission"]["instruction"])
        if len(told) == 1:
            mission.instructing(words, "page")
            return MissionAnswer(waypoint={"forward_m": 2, "left_m": 0})
        return MissionAnswer(done=True, answer="black", marks=(Mark(dot=0, label="tyre"),))

    told = []
    cfg = dataclasses.replace(MissionCfg(), latency="0", pilot=dataclasses.replace(MissionCfg().pilot))
    mission = Mission(WORLD, cfg, RuleAdvisor({"reef-mission": rules}), folder)
    result = mission.run()
    return told, result, [json.loads(line) for line in (folder / "events.jsonl").read_text().splitlines()]


def test_a_changed_instruction_is_in_the_next_question_and_nobody_judges_it(tmp_path):
    told, result, events = changing(tmp_path / "run", " Say what colour the tyre is. ")
    assert told == [WORLD.mission.instruction, "Say what colour the tyre is."]
    changes = [(e["text"], e["by"]) for e in events if e["event"] == "instruction"]
    assert changes == [(WORLD.mission.instruction, "start"), ("Say what colour the tyre is.", "page")]
    assert (result["success"], result["answer"], result["conditions"]) == (None, "black", [])
    assert [e["cause"] for e in events if e["event"] == "trigger" and e["fired"]][-1] == "instruction"
    assert [s["label"] for s in events[[e["event"] for e in events].index("held")]["said"]] == ["tyre"]


def test_the_words_of_the_mission_are_judged_again(tmp_path):
    _, result, _ = changing(tmp_path / "run", WORLD.mission.instruction)
    assert result["success"] is not None
    assert len(result["conditions"]) == 3
