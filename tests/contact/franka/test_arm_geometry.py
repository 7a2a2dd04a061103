"""Kinematics of the arm and the distance of its links."""

import numpy as np
import pytest
from arms import START

from coral.contact.franka.arm_geometry import link_frames, self_distance

FLANGE_TO_TOOL = np.array([0.0, 0.0, 0.107 + 0.1034, 1.0])


def test_the_tool_of_the_start_posture_is_where_the_arm_says():
    """Reported by franky-sim's arm in this posture."""
    tool = link_frames(START)[7] @ FLANGE_TO_TOOL
    assert tool[:3] == pytest.approx([0.489, 0.0, 0.268], abs=1e-3)


def test_a_straight_arm_is_as_high_as_the_data_sheet_says():
    straight = np.zeros(7)
    assert (link_frames(straight)[7] @ np.array([0, 0, 0.107, 1]))[:3] == pytest.approx([0.088, 0.0, 0.926], abs=1e-9)


def test_the_start_posture_has_room_and_a_folded_arm_has_none():
    folded = np.array([0.0, -1.7, 0.0, -3.0, 0.0, 0.6, 0.0])
    assert self_distance(START) > 0.02
    assert self_distance(folded) < 0.01


def test_turning_the_base_changes_no_distance():
    turned = START + np.array([1.0, 0, 0, 0, 0, 0, 0])
    assert self_distance(turned) == pytest.approx(self_distance(START))
