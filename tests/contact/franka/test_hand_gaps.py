"""What the hand may run into, from poses and shapes."""

import numpy as np
import pytest

from coral.contact.franka.hand_gaps import TOUCHING_M, HandGaps
from coral.contact.scene.observation import BodyState
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task

DOWN = np.array([0.0, 1.0, 0.0, 0.0])
LEVEL = np.array([1.0, 0.0, 0.0, 0.0])
PAD_M = 0.008
"""The fingers reach so far beyond the tool."""


@pytest.fixture(scope="module")
def trial():
    return sample_trial(load_task("flip-wall"), 0, "flip-wall")


@pytest.fixture(scope="module")
def hand_gaps(trial):
    return HandGaps(trial)


def tool(*position, quaternion=DOWN):
    return BodyState(np.array(position, float), quaternion)


def box_at(trial, x, y, lift=0.0):
    return {"box": BodyState(np.array([x, y, trial.size("box")[2] / 2 + lift]), LEVEL)}


def narrowest(gaps):
    return min(gaps, key=lambda gap: gap.distance_m)


def test_in_free_air_there_is_no_gap(hand_gaps, trial):
    assert hand_gaps.gaps(tool(0, 0, 0.3), 0.08, box_at(trial, 0, 0), 0.12) == []


def test_above_the_table_the_gap_points_down(hand_gaps, trial):
    gap = narrowest(hand_gaps.gaps(tool(-0.2, -0.3, 0.05), 0.0, box_at(trial, 0, 0.1), 0.12))
    assert gap.distance_m == pytest.approx(0.05 - PAD_M, abs=1e-4)
    assert gap.direction == pytest.approx([0, 0, -1], abs=1e-4)
    assert gap.lever_m[2] == pytest.approx(-PAD_M + 0.004, abs=1e-4)


def test_closed_fingers_above_a_box(hand_gaps, trial):
    top = trial.size("box")[2]
    gap = narrowest(hand_gaps.gaps(tool(0, 0, top + PAD_M + 0.02), 0.0, box_at(trial, 0, 0), 0.12))
    assert gap.distance_m == pytest.approx(0.02, abs=1e-4)
    assert gap.direction == pytest.approx([0, 0, -1], abs=1e-4)


def test_touching_things_have_a_direction(hand_gaps, trial):
    gap = narrowest(hand_gaps.gaps(tool(-0.2, -0.3, PAD_M), 0.0, box_at(trial, 0, 0.1), 0.12))
    assert gap.distance_m == pytest.approx(0.0, abs=1e-4)
    assert gap.direction == pytest.approx([0, 0, -1], abs=1e-4)


def test_beside_the_wall_the_gap_points_to_it(hand_gaps, trial):
    gaps = hand_gaps.gaps(tool(0.15, 0.25, 0.12), 0.0, box_at(trial, -0.1, -0.1), 0.12)
    to_wall = narrowest([gap for gap in gaps if gap.direction[0] > 0.99])
    assert to_wall.distance_m == pytest.approx(0.2 - 0.15 - 0.0315, abs=1e-3)  # the palm is wider than the fingers


def test_what_is_pushed_may_run_into_the_wall(hand_gaps, trial):
    """The hand touches the box's near end; between the box's far end and the wall are 3 cm."""
    half = trial.size("box")[0] / 2
    x = 0.2 - 0.03 - half
    touching = hand_gaps.gaps(tool(x - half - 0.0105, 0, 0.03), 0.0, box_at(trial, x, 0), 0.12)
    far_end = [gap for gap in touching if gap.direction[0] > 0.99 and gap.distance_m > TOUCHING_M]
    assert narrowest(far_end).distance_m == pytest.approx(0.03, abs=1e-3)
    away = hand_gaps.gaps(tool(x - half - 0.05, 0, 0.03), 0.0, box_at(trial, x, 0), 0.12)
    assert not [gap for gap in away if gap.direction[0] > 0.99 and gap.distance_m == pytest.approx(0.03, abs=1e-3)]


def test_what_both_fingers_touch_is_no_obstacle_to_them_but_may_run_into_others(hand_gaps, trial):
    width = trial.size("box")[1]
    objects = box_at(trial, 0, 0, lift=0.05)
    held = hand_gaps.gaps(tool(0, 0, objects["box"].position[2]), width, objects, 0.04)
    assert not [gap for gap in held if abs(gap.direction[1]) > 0.9]
    below = hand_gaps.gaps(tool(0, 0, objects["box"].position[2]), width, objects, 0.06)
    assert narrowest([gap for gap in below if gap.direction[2] < -0.9]).distance_m < 0.051


def test_an_object_that_was_not_seen_yet_is_not_considered(hand_gaps):
    assert hand_gaps.gaps(tool(0, 0, 0.3), 0.08, {}, 0.12) == []
