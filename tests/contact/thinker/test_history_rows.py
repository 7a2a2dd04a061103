import numpy as np
from histories import TOOL, history, sliding

from coral.contact.thinker.history_rows import recent

BOX = (0.1, 0.0, 0.03)
AHEAD = (0.0, 0.0, 0.33)


def test_rows_carry_the_cost_of_their_own_plan():
    steps = history(5, period_s=0.1, box=BOX)
    rows = recent(steps, [(0.0, 9.0), (0.2, 7.0), (0.4, 5.0)], "box")
    assert [row["cost"] for row in rows] == [9.0, 9.0, 7.0, 7.0, 5.0]


def test_before_the_first_plan_its_cost_is_shown_and_without_one_none():
    steps = history(2, period_s=0.1, box=BOX)
    assert [row["cost"] for row in recent(steps, [(0.1, 4.0)], "box")] == [4.0, 4.0]
    assert [row["cost"] for row in recent(steps, [], "box")] == [None, None]


def test_a_row_tells_what_was_commanded_and_what_came_of_it():
    (row,) = recent(history(1, box=sliding(2.0), told=AHEAD, force=(0.0, 1.234, 0.0)), [], "box")
    assert row["time_s"] == 0.02
    assert row["object_pos"] == [0.002, 0.0, 0.03]
    assert row["object_moved_mm"] == 2.0
    assert row["hand_pos"] == list(TOOL)
    assert row["hand_told_to"] == list(AHEAD)
    assert row["opening_told_m"] == 0.08
    assert row["force_on_hand_n"] == [0.0, 1.23, 0.0]


def test_rows_are_spread_over_the_stretch_from_its_first_to_its_last_step():
    rows = recent(history(100, box=BOX), [], "box", most=3)
    np.testing.assert_allclose([row["time_s"] for row in rows], [0.02, 1.0, 2.0])
    assert len(recent(history(2, box=BOX), [], "box", most=5)) == 2
    assert recent([], [], "box") == []
