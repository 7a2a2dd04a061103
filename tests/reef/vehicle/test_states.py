"""Who may move the vehicle from state to state."""

import pytest

from coral.reef.vehicle.states import CHANGES, Mover, PilotState, StateMachine


def machine(*steps):
    """A machine after (who, cause) steps, each of which must be allowed."""
    made = StateMachine()
    for k, (who, cause) in enumerate(steps):
        assert made.move(float(k), who, cause), (who, cause)
    return made


BEGUN = (Mover.GUARD, "sensors good")
LOST = (Mover.GUARD, "sensors lost")


def test_lost_sensors_stop_the_vehicle_and_it_goes_on_when_they_are_back():
    made = machine(BEGUN, LOST)
    assert made.state is PilotState.HOLDING
    assert made.since_s == 1.0
    assert made.move(2.0, Mover.GUARD, "sensors back")
    assert made.state is PilotState.SURVEYING


def test_a_hold_of_the_operator_does_not_end_with_the_sensors():
    made = machine(BEGUN, LOST, (Mover.OPERATOR, "hold"))
    assert not made.move(3.0, Mover.GUARD, "sensors back")
    assert not made.move(99.0, Mover.GUARD, "held too long")
    assert made.state is PilotState.HOLDING
    assert made.since_s == 1.0  # it has stood still since then, whoever holds it now
    assert made.move(4.0, Mover.OPERATOR, "go on")


def test_a_surfacing_vehicle_never_dives_by_itself():
    made = machine(BEGUN, LOST, (Mover.GUARD, "held too long"))
    assert made.state is PilotState.SURFACING
    for who, cause in {(row.who, row.cause) for row in CHANGES if row.who is not Mover.OPERATOR}:
        if cause not in ("at the surface", "end"):
            assert not made.move(9.0, who, cause)


@pytest.mark.parametrize("who", [Mover.GUARD, Mover.VEHICLE])
def test_nobody_takes_the_vehicle_from_a_person(who):
    made = machine(BEGUN, (Mover.OPERATOR, "take over"))
    assert not any(made.move(9.0, who, row.cause) for row in CHANGES if row.who is who)
    assert made.state is PilotState.TAKEN_OVER


def test_what_has_stopped_stays_so():
    made = machine(BEGUN, (Mover.MISSION, "end"))
    assert not any(made.move(9.0, row.who, row.cause) for row in CHANGES)
    assert made.state is PilotState.STOPPED


def test_every_change_is_told_with_its_reason():
    told = []
    made = StateMachine(lambda *change: told.append(change))
    made.move(0.0, *BEGUN)
    made.move(1.0, *LOST, "camera: blind for 0.5 s")
    assert told[-1] == (
        PilotState.SURVEYING, PilotState.HOLDING, "sensors lost", Mover.GUARD, "camera: blind for 0.5 s",
    )  # fmt: skip
    assert made.reason == "camera: blind for 0.5 s"


def test_no_two_rows_compete():
    keys = [(row.source, row.cause, row.who) for row in CHANGES]
    assert len(keys) == len(set(keys))


def test_every_state_can_be_reached_and_ended():
    assert {row.target for row in CHANGES} == set(PilotState) - {PilotState.READY}
    assert {row.source for row in CHANGES} == set(PilotState) - {PilotState.STOPPED}
