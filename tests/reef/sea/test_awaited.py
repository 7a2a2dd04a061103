import math

import pytest

from coral.reef.sea.awaited import awaited
from coral.reef.vehicle.states import Mover, PilotState, StateMachine

SURVEYING = [(Mover.GUARD, "sensors good")]


def words(*moves, passing=True, surface_after_s=math.inf):
    states = StateMachine()
    for k, (who, cause) in enumerate(moves):
        assert states.move(float(k), who, cause)
    return awaited(states, passing=passing, settle_s=2.0, recover_s=1.0, surface_after_s=surface_after_s)


def test_every_state_says_what_ends_it_but_surveying():
    said = {}
    for state in PilotState:
        states = StateMachine()
        states.state = state
        said[state] = awaited(states, passing=False, settle_s=2.0, recover_s=1.0, surface_after_s=math.inf)
    assert [state for state, text in said.items() if not text] == [PilotState.SURVEYING, PilotState.STOPPED]


@pytest.mark.parametrize(
    ("moves", "given", "text"),
    [
        ([], {}, "begins when every sensor"),
        ([*SURVEYING, (Mover.GUARD, "sensors lost")], {}, "good for 1 s, or on your word"),
        ([*SURVEYING, (Mover.GUARD, "sensors lost")], {"surface_after_s": 60.0}, "surfaces after 60 s"),
        ([*SURVEYING, (Mover.VEHICLE, "fault")], {}, "gone for 2 s"),
        ([*SURVEYING, (Mover.VEHICLE, "fault")], {"passing": False}, "only on your word"),
        ([*SURVEYING, (Mover.OPERATOR, "hold")], {}, "only on your word"),
        ([*SURVEYING, (Mover.OPERATOR, "take over")], {}, "given back"),
        ([*SURVEYING, (Mover.VEHICLE, "must surface")], {}, "at the surface"),
    ],
)
def test_a_hold_ends_by_whoever_began_it(moves, given, text):
    assert text in words(*moves, **given)
