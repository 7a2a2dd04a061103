from types import SimpleNamespace

import pytest

from coral.contact.cost.stages import TermWeights
from coral.reef.world.instruction import checked_words
from coral.view.live.controls import STOPPED, Pace, RunControls, SurveyControls


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


class Wall:
    def __init__(self):
        self.now, self.rests = 0.0, []

    def clock(self):
        return self.now

    def wait(self, seconds):
        self.rests.append(seconds)
        self.now += seconds


def test_a_speed_limit_holds_and_nothing_is_hurried():
    wall = Wall()
    pace = Pace(2.0, clock=wall.clock, wait=wall.wait)
    for k in range(101):
        pace.keep(0.1 * k)
    assert wall.now == pytest.approx(5.0)
    wall.now += 60.0  # the machine was busy
    pace.keep(10.1)
    pace.keep(10.2)
    assert wall.now == pytest.approx(65.05)
    pace.speed = 0.0
    pace.keep(1000.0)
    assert wall.now == pytest.approx(65.05)


def test_standing_still_ends_with_the_pause_or_the_run():
    waited = []

    def wait(seconds):
        waited.append(seconds)
        if len(waited) == 3:
            pace.paused = False
        if len(waited) == 4:
            pace.end()

    pace = Pace(clock=Wall().clock, wait=wait)
    assert not pace.stand_still()
    pace.paused = True
    assert pace.stand_still()
    assert len(waited) == 3
    pace.paused = True
    assert pace.stand_still()
    assert pace.stop
    assert not pace.stand_still()
    assert len(waited) == 4


def test_the_first_reason_to_end_stays_and_nothing_waits_any_more():
    wall = Wall()
    pace = Pace(1.0, clock=wall.clock, wait=wall.wait)
    pace.keep(0.0)
    pace.end("enough")
    pace.end()
    pace.keep(1000.0)
    assert (pace.stop, wall.now) == ("enough", 0.0)
