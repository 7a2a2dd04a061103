"""The named states of a vehicle under way, and the table of who may move it from one to another, and why."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum


class PilotState(StrEnum):
    """What the vehicle is doing."""

    READY = "ready"
    """It has not begun: it waits for its sensors, and stands still."""
    SURVEYING = "surveying"
    """The pilot drives."""
    HOLDING = "holding"
    """It stands still, and continues by itself only if the reason passes."""
    SURFACING = "surfacing"
    """It gives up the survey and comes up where it is."""
    STOPPED = "stopped"
    """The survey is over; nothing moves it."""
    TAKEN_OVER = "taken over"
    """A person steers; the pilot sends no commands."""


class Mover(StrEnum):
    """Who moves the vehicle from state to state."""

    GUARD = "guard"
    """The checks of the sensors, `SensorGuard`."""
    VEHICLE = "vehicle"
    """The driver of the vehicle: link, autopilot, battery, leak, geofence."""
    OPERATOR = "operator"
    """A person, by the page, the keyboard or the joystick."""
    MISSION = "mission"
    """The end of the survey."""


@dataclass(frozen=True)
class StateChange:
    """One row of the table."""

    source: PilotState
    cause: str
    target: PilotState
    who: Mover
    means: str
    """When it happens, in a sentence for the documentation."""
    after: Mover | None = None
    """Only if this one caused the present state: a hold ends by the word of whoever began it. None: always."""


_READY, _SURVEYING, _HOLDING = PilotState.READY, PilotState.SURVEYING, PilotState.HOLDING
_SURFACING, _STOPPED, _TAKEN_OVER = PilotState.SURFACING, PilotState.STOPPED, PilotState.TAKEN_OVER
_GUARD, _VEHICLE, _OPERATOR, _MISSION = Mover.GUARD, Mover.VEHICLE, Mover.OPERATOR, Mover.MISSION

CHANGES: tuple[StateChange, ...] = (
    StateChange(_READY, "sensors good", _SURVEYING, _GUARD, "Every sensor has delivered something that passes."),
    StateChange(_SURVEYING, "sensors lost", _HOLDING, _GUARD, "An input has been missing or wrong for too long."),
    StateChange(_HOLDING, "sensors back", _SURVEYING, _GUARD, "All inputs have passed for a second.", _GUARD),
    StateChange(_HOLDING, "held too long", _SURFACING, _GUARD, "The sensors do not come back.", _GUARD),
    StateChange(_SURVEYING, "fault", _HOLDING, _VEHICLE, "The link is lost, the geofence is reached."),
    StateChange(_HOLDING, "fault", _HOLDING, _VEHICLE, "The same, while the sensors are lost.", _GUARD),
    StateChange(_HOLDING, "fault passed", _SURVEYING, _VEHICLE, "The link is back.", _VEHICLE),
    StateChange(_SURVEYING, "must surface", _SURFACING, _VEHICLE, "Low battery, a leak."),
    StateChange(_HOLDING, "must surface", _SURFACING, _VEHICLE, "The same, or a fault that has lasted too long."),
    StateChange(_SURVEYING, "hold", _HOLDING, _OPERATOR, "The operator stops the vehicle."),
    StateChange(_HOLDING, "hold", _HOLDING, _OPERATOR, "The operator makes a hold last until his word."),
    StateChange(_HOLDING, "go on", _SURVEYING, _OPERATOR, "The operator lets the vehicle continue."),
    StateChange(_SURFACING, "hold", _HOLDING, _OPERATOR, "The operator stops the ascent."),
    StateChange(_SURVEYING, "surface", _SURFACING, _OPERATOR, "The operator ends the survey."),
    StateChange(_HOLDING, "surface", _SURFACING, _OPERATOR, "The same."),
    *(
        StateChange(source, "take over", _TAKEN_OVER, _OPERATOR, "A person steers: joystick, QGroundControl.")
        for source in (_READY, _SURVEYING, _HOLDING, _SURFACING)
    ),
    StateChange(_TAKEN_OVER, "go on", _SURVEYING, _OPERATOR, "The person gives the vehicle back."),
    StateChange(_TAKEN_OVER, "hold", _HOLDING, _OPERATOR, "The person gives it back standing still."),
    StateChange(_SURFACING, "at the surface", _STOPPED, _VEHICLE, "The ascent is done."),
    *(
        StateChange(source, "end", _STOPPED, _MISSION, "The survey has ended; its reason is given.")
        for source in (_READY, _SURVEYING, _HOLDING, _SURFACING, _TAKEN_OVER)
    ),
)
"""All changes there are. What is not here does not happen: a surfacing vehicle never dives by itself, and nobody but a
person takes the vehicle from a person."""

Hear = Callable[[PilotState, PilotState, str, Mover, str], None]
"""hear(source, target, cause, who, reason) is told of every change."""


class StateMachine:
    """Keeps the state of one vehicle."""

    def __init__(self, hear: Hear | None = None) -> None:
        self.state = PilotState.READY
        self.since_s = 0.0
        """Time of the last change of state."""
        self.reason = ""
        """Why the vehicle is in this state."""
        self.by: Mover | None = None
        """Who brought it into this state; None at the start."""
        self._hear = hear

    def move(self, t: float, who: Mover, cause: str, reason: str = "") -> bool:
        """Apply a row of the table at time `t` (s), if there is one. Return whether there was.

        `reason` are words for people; the cause by default.
        """
        for row in CHANGES:
            if (row.source, row.cause, row.who) == (self.state, cause, who) and row.after in (None, self.by):
                break
        else:
            return False
        source, self.state, self.by, self.reason = self.state, row.target, who, reason or cause
        if row.target is not source:
            self.since_s = t
        if self._hear is not None:
            self._hear(source, row.target, cause, who, self.reason)
        return True
