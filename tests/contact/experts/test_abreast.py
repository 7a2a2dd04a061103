"""Two fingers abreast behind a face: where they stand, how the hand is turned, what coming down costs."""

import numpy as np
import pytest

from coral.contact.experts.abreast import ABREAST_M, facing, on_box, palm_down, reach_terms
from coral.contact.experts.terms import axis
from coral.contact.scene.geometry import from_rpy_deg


def test_points_of_a_box_turn_with_it(state_of):
    state = state_of(
        "flip-wall", box_pos=[0.1, 0.2, 0.03], box_quat=from_rpy_deg([0, 0, 90]), box_size=[0.1, 0.08, 0.06]
    )
    assert on_box(state, "box", 1.0, 0.0)[0, 0] == pytest.approx([0.1, 0.25, 0.03])
    assert on_box(state, "box", -1.0, 1.0)[0, 0] == pytest.approx([0.1, 0.15, 0.06])


@pytest.mark.parametrize("yaw", [0.0, 35.0, -90.0, 170.0])
def test_the_palm_is_down_and_the_fingers_stand_across_the_way_ahead(yaw, state_of):
    ahead = np.array([np.cos(np.radians(yaw)), np.sin(np.radians(yaw)), 0.0])
    hand = palm_down(ahead)
    assert axis(hand, "z") == pytest.approx([0.0, 0.0, -1.0])
    assert axis(hand, "x") == pytest.approx(ahead)
    assert facing(state_of("flip-wall", box_quat=from_rpy_deg([0, 0, yaw])), "box") == pytest.approx(hand)


def test_coming_down_costs_nothing_at_the_target_and_more_from_the_side_than_from_above(state_of):
    target = np.array([[[-0.1, 0.0, 0.02]]])

    def cost(place):
        state = state_of("flip-wall", ee_pos=place, gripper_target=ABREAST_M)
        terms = reach_terms(state, "box", target, np.zeros((1, 1)), above_m=0.09)
        return float(sum(np.asarray(term).item() for term in terms.values()))

    assert cost(target) == pytest.approx(0.0)
    above, aside = np.array([0.0, 0.0, 0.06]), np.array([0.0, 0.06, 0.0])
    assert cost(target + above) == pytest.approx(12.0 * 0.06)
    assert cost(target + aside) == pytest.approx(12.0 * 0.06 + 30.0 * 0.9 * 0.07)
