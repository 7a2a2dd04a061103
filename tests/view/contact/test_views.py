import re
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest

from coral.view.contact.replay import trial_of_run
from coral.view.contact.views import SIDES, ViewPanel, three_views, touch_views
from coral.view.run import RunFolder


@pytest.fixture(scope="module")
def run(recorded):
    return RunFolder.read(recorded)


@pytest.fixture(scope="module")
def trial(run):
    return trial_of_run(run)


def test_a_panel_shows_two_axes_with_up_upwards():
    panel = ViewPanel(10.0, 20.0, 100.0, np.array([-1.0, -2.0, 0.0]), across=0, up=2, height=50.0)
    assert panel(np.array([[-1.0, 7.0, 0.0], [0.0, 7.0, 0.5]])).tolist() == [[10.0, 70.0], [110.0, 20.0]]


def test_tool_and_objects_are_shown_from_three_sides(run, trial):
    root = ET.fromstring(three_views(run, trial))
    texts = [e.text for e in root.iter("text")]
    assert [name for name, _, _ in SIDES] == [said for said in texts if said.startswith("from")]
    assert {"tool", "box"} <= set(texts)
    assert texts.count("10 cm") == 3
    assert len(list(root.iter("polyline"))) == 3 * 2


def test_everything_lies_inside_the_drawing(run, trial):
    svg = three_views(run, trial)
    width, height = (float(v) for v in ET.fromstring(svg).get("viewBox").split()[2:])
    spots = np.array(
        [spot.split(",") for points in re.findall(r'points="([^"]+)"', svg) for spot in points.split()], float
    )
    assert (spots >= 0).all()
    assert (spots <= (width, height)).all()


def test_without_a_trajectory_there_is_nothing_to_draw(run, trial):
    empty = replace(run, trajectory={})
    assert three_views(empty, trial) == ""
    assert touch_views(empty, trial, "box") == ""


def test_each_touch_is_a_dot_in_each_view_from_blue_to_red(run, trial):
    n = 50
    touches = {f"box_touch_{axis}": np.full(n, 0.01) for axis in "xyz"}
    forces = np.linspace(0.0, 9.0, n)
    forced = replace(run, trajectory={**touches, "box_hand_force": forces})
    dots = list(ET.fromstring(touch_views(forced, trial, "box")).iter("circle"))
    assert len(dots) == 3 * n
    assert "#195ae6" in dots[0].get("style")
    assert "#c8352b" in dots[n - 1].get("style")
    assert float(dots[0].get("r")) < float(dots[n - 1].get("r"))
