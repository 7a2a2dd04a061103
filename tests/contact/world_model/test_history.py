import dataclasses

import numpy as np
import pytest
from histories import TOOL, history, sliding

from coral.contact.world_model import history as module
from coral.contact.world_model.history import most_informative_object, windows

NEAR, FAR = (0.0, 0.0, 0.1), (0.0, 0.0, -0.1)


def firsts(found):
    """The step at which each window begins."""
    return [round(window[0].before.time_s / 0.02) for window in found]


def test_a_history_without_touch_says_nothing():
    still = history(30, box=NEAR)
    assert windows(still, "box") == []
    assert most_informative_object(still) is None
    assert most_informative_object([]) is None


def test_windows_of_an_object_that_slides_overlap_by_half():
    found = windows(history(24, box=sliding(1.0)), "box")
    assert firsts(found) == [0, 6, 12]
    assert {len(window) for window in found} == {12}


def test_a_history_shorter_than_a_window_has_none():
    assert windows(history(11, box=sliding(1.0)), "box") == []


def test_what_resists_a_force_tells_something_where_the_hand_is_near_it():
    assert firsts(windows(history(12, box=NEAR, force=(1.0, 0.0, 0.0)), "box")) == [0]
    assert windows(history(12, box=FAR, force=(1.0, 0.0, 0.0)), "box") == []
    assert windows(history(12, box=NEAR, force=(0.2, 0.0, 0.0)), "box") == []


@pytest.mark.parametrize(("most", "kept"), [(1, [24]), (3, [0, 18, 24])])
def test_the_windows_that_tell_most_are_kept_in_the_order_of_time(monkeypatch, most, kept):
    # 1 mm per step until step 12, nothing until 24, then 3 mm
    def place(k):
        return np.array([0.001 * min(k, 12) + 0.003 * max(0, k - 24), 0.0, 0.03])

    steps = history(36, box=place)
    monkeypatch.setattr(module, "MOST", most)
    assert firsts(windows(steps, "box")) == kept


def test_no_window_spans_a_gap_in_time_or_begins_where_no_replay_can():
    steps = history(12, box=sliding(1.0)) + history(12, box=sliding(1.0), start_s=1.0)
    assert firsts(windows(steps, "box")) == [0, 50]
    assert firsts(windows(steps, "box", usable=lambda start: start.time_s > 0.5)) == [50]


def test_the_object_that_moved_farthest_tells_most_though_it_came_back():
    def to_and_fro(k):
        return np.array([0.002 * (k % 2), 0.0, 0.03])

    assert most_informative_object(history(10, box=sliding(1.0), cup=to_and_fro)) == "cup"


def test_where_nothing_moved_it_is_the_one_nearest_to_the_hand_when_it_felt_most():
    def tool(k):
        return (0.0, 0.0, 0.3) if k < 6 else (0.5, 0.0, 0.3)

    def force(k):
        return (2.0 if k == 8 else 0.4, 0.0, 0.0)

    objects = {"box": (0.0, 0.0, 0.2), "cup": (0.5, 0.0, 0.1)}
    assert most_informative_object(history(10, tool=tool, force=force, **objects)) == "cup"
    assert most_informative_object(history(7, tool=tool, force=force, **objects)) is None


def test_a_torque_is_not_a_touch():
    twist = np.array([0.0, 0.0, 0.0, 5.0, 0.0, 0.0])
    steps = [
        dataclasses.replace(step, after=dataclasses.replace(step.after, wrench=twist)) for step in history(12, box=TOOL)
    ]
    assert windows(steps, "box") == []
    assert most_informative_object(steps) is None
