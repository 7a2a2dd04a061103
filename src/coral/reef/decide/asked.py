"""A question as a value, with the state in which its answer is judged."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from coral.advisor.question import Question
from coral.reef.decide.outlook import Outlook
from coral.reef.decide.remaining import Remaining
from coral.reef.decide.route import Goal
from coral.reef.decide.survey import Survey
from coral.reef.decide.topology import RemainingTour
from coral.reef.decide.verify import Surroundings

Mode = Literal["centroid", "waypoint", "mission"]


@dataclass(frozen=True, kw_only=True)
class AskedState:
    """A question, and the state in which its answer is judged."""

    question: Question[Any] | None
    """None: there is nothing to choose."""
    mode: Mode
    outlook: Outlook
    left: Survey
    """What was left to explore."""
    around: Surroundings
    """The inputs of Eqs. 4-8."""
    remaining: Remaining | None = None
    """What was left, with the known ways, where that is measured."""
    tour: RemainingTour | None = None
    """The tour of all that was left, where one is planned."""
    alone: Goal | None = None
    """Where the robot goes on exploring without a question: the advisor has left that to its own tour."""
    finished: bool = False
    """Nothing is left that the robot could visit or explore, and it is on its way to nothing."""
    acceptable: bool = False
    """Whether any of the choices on offer would pass."""
