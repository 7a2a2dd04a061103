from types import SimpleNamespace

import pytest

from coral.view.live.pace import STOPPED, Pace
from coral.view.live.panel import UNLIMITED, MissionControls, ReplayControls, named, speeds
from coral.view.live.state import LiveState


class Gui:
    """Buttons of a page, which a test presses."""

    def __init__(self):
        self.handles = {}

    def _add(self, label, value=None, **_):
        handle = SimpleNamespace(label=label, value=value, disabled=False, press=None)
        handle.on_click = handle.on_update = lambda act: setattr(handle, "press", act)
        self.handles[label] = handle
        return handle

    def add_button(self, label, **look):
        return self._add(label)

    def add_dropdown(self, label, choices, *, initial_value):
        assert initial_value in choices
        return self._add(label, initial_value)

    def add_slider(self, label, low, high, step, value):
        return self._add(label, value)


def test_the_speed_to_begin_with_can_be_chosen_again():
    assert list(speeds(4.0)) == [
        "real time",
        "2 × real time",
        "4 × real time",
        "5 × real time",
        "10 × real time",
        "20 × real time",
    ]
    assert speeds(0.0) == speeds(5.0)
    assert named(0.0) == "as fast as possible"


def test_a_mission_is_paused_resumed_slowed_and_stopped():
    gui, pace = Gui(), Pace(5.0)
    controls = MissionControls(pace)
    controls.build(gui)
    pause, stop, speed = gui.handles["Pause"], gui.handles["Stop the mission"], gui.handles["Speed limit"]
    pause.press(None)
    assert (pace.paused, pause.label) == (True, "Resume")
    pause.press(None)
    assert (pace.paused, pause.label) == (False, "Pause")
    speed.value = UNLIMITED
    speed.press(None)
    assert pace.speed == 0.0
    stop.press(None)
    assert pace.stop == STOPPED


@pytest.mark.parametrize(("status", "disabled"), [("running", False), ("ended: time limit", True)])
def test_an_ended_mission_cannot_be_stopped_again(status, disabled):
    gui, controls = Gui(), MissionControls(Pace())
    controls.build(gui)
    controls.show(LiveState(title="x", status=status))
    assert {handle.disabled for handle in gui.handles.values()} == {disabled}


def test_a_recording_is_sought_by_the_viewer_and_not_by_its_own_slider():
    gui, pace, sought = Gui(), Pace(1.0), []
    controls = ReplayControls(pace, 40.0, sought.append, lambda on: setattr(pace, "paused", not on))
    controls.build(gui)
    time = gui.handles["Time (s)"]
    time.value = 12.5
    time.press(SimpleNamespace(client=None))
    assert sought == []
    time.press(SimpleNamespace(client=object()))
    assert sought == [12.5]


def test_the_slider_follows_the_recording_and_the_button_says_what_it_does():
    gui, pace = Gui(), Pace(1.0)
    controls = ReplayControls(pace, 40.0, lambda t: None, lambda on: setattr(pace, "paused", not on))
    controls.build(gui)
    play, time = gui.handles["Play"], gui.handles["Time (s)"]
    for t, shown in ((-1.0, 0.0), (12.34, 12.3), (99.0, 40.0)):
        controls.show(LiveState(title="x", t=t))
        assert time.value == shown
    assert play.label == "Pause"
    play.press(None)
    controls.show(LiveState(title="x"))
    assert (pace.paused, play.label) == (True, "Play")
