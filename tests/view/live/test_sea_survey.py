from types import SimpleNamespace

import pytest
from viser._icons import svg_from_icon

from coral.reef.map.belief import Belief
from coral.reef.map.mapping import OccupancyMap
from coral.reef.sea.link import VehicleReport
from coral.reef.sea.operator import OperatorWords
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.vehicle.states import PilotState
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import load_world
from coral.view.live.sea_survey import BUTTONS, RESUME_BUTTONS, LiveSurvey, SurveyControls
from coral.view.live.state import LiveState


class Page:
    def __init__(self):
        self.states, self.ready = [], True

    def due(self):
        return self.ready

    def show(self, state):
        self.states.append(state)


class Gui:
    def __init__(self):
        self.clicks = {}

    def add_button(self, label, **_):
        return SimpleNamespace(disabled=False, on_click=lambda click: self.clicks.__setitem__(label, click))


def mission():
    world, cfg = load_world("s1"), CameraCfg()
    belief = Belief(OccupancyMap(world.size_m, cfg))
    pose = Pose(world.start.x, world.start.y, world.start.theta)
    belief.update(Camera(Scene.from_world(world), cfg).render(pose), pose)
    return SimpleNamespace(
        area=SimpleNamespace(name="s1"),
        crew=SimpleNamespace(advisor=SimpleNamespace(name="heuristic"), world=world),
        record=SimpleNamespace(listeners=[]),
        pilot=SimpleNamespace(plan=None, monitor=SimpleNamespace(path=belief.trajectory)),
        states=SimpleNamespace(state=PilotState.HOLDING, reason="link lost"),
        report=VehicleReport(velocity=(0.2, 0.0, 0.0), battery_fraction=0.75),
        belief=belief,
        end_reason="",
        t=12.0,
        coverage=0.25,
        notice="goes on only on your word",
    )


def test_the_state_of_the_vehicle_and_its_battery_are_shown():
    page, one = Page(), mission()
    survey = LiveSurvey(one, page, threaded=False)
    survey.hear({"event": "collision", "t": 3.0})
    survey.tick(one)
    survey.close()
    state = page.states[-1]
    assert (state.status, state.note) == ("holding - link lost", "goes on only on your word")
    assert {number.name: number.value for number in state.numbers}["battery"] == "75%"
    assert {number.name: number.value for number in state.numbers}["collisions"] == "1"


def test_a_page_that_is_busy_gets_nothing_but_the_end():
    page, one = Page(), mission()
    survey = LiveSurvey(one, page, threaded=False)
    page.ready = False
    survey.tick(one)
    survey.close()
    assert page.states == []
    one.end_reason = "time limit"
    survey.tick(one)
    survey.close()
    assert page.states[-1].status == "ended: time limit"


def test_a_button_says_its_word():
    words, gui = OperatorWords(), Gui()
    controls = SurveyControls(words)
    controls.build(gui)
    gui.clicks["Stop the survey"](None)
    gui.clicks["Hold"](None)
    assert words.take() == [("stop", "page"), ("hold", "page")]


def test_only_arming_is_offered_before_and_nothing_after():
    controls = SurveyControls(OperatorWords())
    controls.build(Gui())
    controls.show(LiveState(title="s1", status="preflight"))
    assert [word for word, button in controls._buttons.items() if not button.disabled] == ["arm"]
    controls.show(LiveState(title="s1", status="surveying"))
    assert controls._buttons["arm"].disabled
    controls.show(LiveState(title="s1", status="ended: time limit"))
    assert all(button.disabled for button in controls._buttons.values())


def test_an_alignment_can_be_used_once_it_is_proposed_and_given_up_before():
    search = SimpleNamespace(outcome="", proposal=None)
    controls = SurveyControls(OperatorWords(), search)
    controls.build(Gui())

    def offered():
        controls.show(LiveState(title="s1", status="surveying"))
        return [word for word in ("align", "unaligned") if not controls._buttons[word].disabled]

    assert offered() == ["unaligned"]
    search.proposal = object()
    assert offered() == ["align", "unaligned"]
    search.outcome = "aligned"
    assert offered() == []


@pytest.mark.parametrize("icon", [button[2] for button in BUTTONS + RESUME_BUTTONS])
def test_every_icon_exists(icon):
    assert svg_from_icon(icon)
