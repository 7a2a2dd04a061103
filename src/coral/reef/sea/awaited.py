"""What would end the present state of a vehicle, in words for the operator."""

from __future__ import annotations

from coral.reef.vehicle.states import Mover, PilotState, StateMachine


def awaited(states: StateMachine, *, passing: bool, settle_s: float, recover_s: float, surface_after_s: float) -> str:
    """Return what would end the state that a vehicle is in; "" for surveying, which every limit ends.

    Args:
        states: The vehicle's states.
        passing: Whether the fault for which it holds may pass by itself.
        settle_s: A fault must be over for this long (s).
        recover_s: Sensors must be good for this long (s).
        surface_after_s: After this long without sensors it comes up (s); inf for never.
    """
    state, by = states.state, states.by
    if state is PilotState.READY:
        return "begins when every sensor has delivered something good"
    if state is PilotState.HOLDING:
        if by is Mover.GUARD:
            after = f"; surfaces after {surface_after_s:.0f} s" if surface_after_s != float("inf") else ""
            return f"continues when all sensors have been good for {recover_s:g} s{after}, or on your word"
        if by is Mover.VEHICLE and passing:
            return f"continues when the cause has been gone for {settle_s:g} s, or on your word"
        return "continues only on your word"
    if state is PilotState.SURFACING:
        return "ends at the surface"
    if state is PilotState.TAKEN_OVER:
        return "continues only on your word, when the vehicle is given back"
    return ""
