"""The buttons and sliders of a contact task's page."""

import contextlib
from types import SimpleNamespace

from coral.contact.control.term_weights import TermWeights
from coral.view.live.pace import STOPPED, Pace
from coral.view.live.state import LiveState
from coral.view.live.task_controls import TaskControls


class Gui:
    """Widgets of a page, which a test moves."""

    def __init__(self):
        self.made, self.folders = {}, []

    def _add(self, label, value=None):
        handle = SimpleNamespace(label=label, value=value, disabled=False)
        handle.on_click = handle.on_update = lambda act: setattr(handle, "act", act)
        self.made[label] = handle
        return handle

    def add_button(self, label, **look):
        return self._add(label)

    def add_dropdown(self, label, choices, *, initial_value):
        return self._add(label, initial_value)

    def add_slider(self, label, low, high, step, value, *, hint):
        assert low <= value <= high
        return self._add(label, value)

    def add_folder(self, name, **look):
        self.folders.append(name)
        return contextlib.nullcontext()


def test_each_term_gets_one_slider_whose_value_acts_on_the_cost():
    gui, weights = Gui(), TermWeights()
    controls = TaskControls(Pace(), weights)
    controls.build(gui)
    controls.offer("reach", ("off", "open"))
    controls.offer("reach", ("off", "open"))
    controls.show(LiveState(title="x"))
    controls.show(LiveState(title="x"))
    assert gui.folders == ["Weights of the cost", "stage reach"]
    gui.made["off"].act(SimpleNamespace(target=SimpleNamespace(value=2.5)))
    assert weights.news() == [("reach", "off", 2.5)]
    controls.show(LiveState(title="x", status="ended: success"))
    assert gui.made["off"].disabled


def test_the_stop_button_stops_an_arm_before_it_ends_the_run():
    pace, calls = Pace(), []
    gui, controls = Gui(), TaskControls(pace, None, lambda: calls.append(pace.stop))
    controls.build(gui)
    controls.offer("reach", ("off",))
    controls.show(LiveState(title="x"))
    assert "off" not in gui.made  # a controller without weights
    gui.made["Stop the task"].act(None)
    assert (calls, pace.stop) == ([""], STOPPED)
