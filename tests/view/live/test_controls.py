from types import SimpleNamespace

import pytest

from coral.contact.cost.stages import TermWeights
from coral.reef.world.instruction import checked_words
from coral.view.live.controls import RunControls, SurveyControls
from coral.view.live.pace import STOPPED, Pace


def by_name(panel):
    return {button["name"]: button for button in panel["buttons"]}


def test_a_run_is_paused_slowed_and_stopped():
    pace, stopped = Pace(5.0), []
    controls = RunControls(pace, "task", stop_now=lambda: stopped.append(1))
    assert controls.press("pause", None)
    assert pace.paused
    assert by_name(controls.panel("paused"))["pause"]["label"] == "Resume"
    assert controls.press("speed", 2)
    assert (pace.speed, controls.panel("running")["speed"]) == (2.0, 2.0)
    assert controls.press("stop", None)
    assert (pace.stop, stopped) == (STOPPED, [1])
    ended = controls.panel(f"ended: {STOPPED}")
    assert all(button["disabled"] for button in ended["buttons"])
    assert ended["speed"] is None


@pytest.mark.parametrize(
    ("name", "value"),
    [("speed", "fast"), ("speed", -1), ("speed", True), ("weight", ["a", "b", 1]), ("arm", None), ("__init__", None)],
)
def test_what_is_no_button_does_nothing(name, value):
    pace = Pace(5.0)
    assert not RunControls(pace).press(name, value)
    assert (pace.speed, pace.paused, pace.stop) == (5.0, False, "")


def test_a_weight_is_the_operators_word_to_the_cost():
    weights = TermWeights()
    controls = RunControls(Pace(), "task", weights)
    assert controls.panel("running")["weights"]
    assert controls.press("weight", ["lift", "up", 9.0])
    assert not controls.press("weight", ["lift", 3, 1.0])
    assert weights.news() == [("lift", "up", 4.0)]


def test_a_survey_is_armed_once_and_steered_until_its_end():
    said = []
    words = SimpleNamespace(say=lambda word, by: said.append((word, by)))
    controls = SurveyControls(words)
    waiting, under_way, ended = (by_name(controls.panel(s)) for s in ("preflight", "surveying", "ended: stopped"))
    assert [name for name, button in waiting.items() if not button["disabled"]] == ["arm"]
    assert under_way["arm"]["disabled"]
    assert not under_way["hold"]["disabled"]
    assert all(button["disabled"] for button in ended.values())
    assert controls.press("hold", None)
    assert not controls.press("speed", 2)
    assert controls.press("home", None)
    assert said == [("hold", "page"), ("home", "page")]


@pytest.mark.parametrize("made", [lambda f: RunControls(Pace(), instruct=f), lambda f: SurveyControls(None, f)])
def test_the_instruction_of_a_mission_in_words_is_changed_on_the_page(made):
    told = []

    def instruct(words, by):
        told.append((checked_words(words), by))
        return True

    controls = made(instruct)
    assert by_name(controls.panel("running"))["instruct"]["asks"]
    assert controls.press("instruct", "Find the net.")
    assert not controls.press("instruct", " ")
    assert not controls.press("instruct", None)
    assert told == [("Find the net.", "page")]
    without = made(None)
    assert "instruct" not in by_name(without.panel("running"))
    assert not without.press("instruct", "Find the net.")
