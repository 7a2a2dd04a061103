"""The interface of a strategist: it gives the first strategy, sees every plan, and may change the strategy."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

from coral.contact.control.hand_controllers import PlannerLimits
from coral.contact.control.hand_plan import HandPlan
from coral.contact.control.planning_world import PlanningWorld
from coral.contact.cost.context import Context
from coral.contact.cost.stages import Strategy
from coral.contact.cost_program.errors import CostError
from coral.contact.perception.advisor_camera import Look
from coral.contact.scene.observation import BodyState, Observation, Transition
from coral.contact.scene.trial import Trial, stated_beliefs
from coral.contact.thinker.thinking_clock import Thinking


@dataclass(frozen=True)
class StrategistCounts:
    """Counts of a strategist's actions, for the metrics."""

    advisor_calls: int = 0
    """Number of requests to an advisor, repetitions after a refusal included."""
    repairs: int = 0
    """Number of changes of strategy or beliefs during the episode."""
    memory_hit: bool = False
    """Whether it began with a remembered plan."""


@dataclass(frozen=True)
class PlanReport:
    """A plan as the strategist sees it: nothing that the robot does not know."""

    now: Observation
    """The latest observation."""
    plan: HandPlan
    stage: str
    """Name of the planned stage."""
    taken: tuple[Transition, ...] = ()
    """Control steps since the previous plan."""
    touched: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """What the left and the right finger and the rest of the hand touch, as measured."""
    sunk_m: Mapping[str, float] = field(default_factory=dict)
    """How deep (m) the hand is inside each object by the believed poses."""
    next_state: Context | None = None
    """Predicted state after the next control step; None if the hand holds still until this plan is ready."""
    present: Context | None = None
    """The measured state as the conditions of the stage read it, a batch of one."""


class NoStrategy(RuntimeError):
    """The advisor has no strategy; the text says why."""


class Strategist(Protocol):
    """Chooses strategies, and beliefs about masses and frictions. A subclass may leave out what does nothing here."""

    @property
    def counts(self) -> StrategistCounts:
        """Return the counts so far."""

    @property
    def guesses_poses(self) -> bool:
        """Return whether poses are estimated once at the start, after which nothing tracks the objects."""
        return False

    def guess_poses(self, trial: Trial, first: Observation) -> Mapping[str, BodyState]:
        """Estimate the objects' poses from a picture; called before `begin` if `guesses_poses`.

        The trial's poses must not be read, and `first` is without any object.
        """
        return {}

    def attach(
        self,
        thinking: Thinking,
        emit: Callable[..., None],
        limits: Callable[[], PlannerLimits],
        look: Look,
        above: Look,
    ) -> None:
        """Attach the episode, which continues while an advisor answers.

        `emit(event, **fields)` appends an event to the run's log; `limits` gives the present limits of the planner, for
        questions about a plan; `look` and `above` take the pictures that are added to questions.
        """
        return

    def begin(self, trial: Trial, first: Observation, world: PlanningWorld) -> Strategy:
        """Return the first strategy; may set the planning world's beliefs.

        Raises:
            NoStrategy: There is no strategy.
            NoDecision: The advisor did not decide, and the policy lets nothing else decide. All methods that ask raise
                it.
            EpisodeOver: The episode ended while an advisor was answering. All methods that ask raise it.
        """

    def on_plan(self, report: PlanReport) -> Strategy | None:
        """Handle a new plan; return a new strategy, or None to keep the present one.

        Raises:
            CostError: A cost failed during planning, and there is nothing left to try.
        """
        return None

    def on_cost_error(self, error: CostError, stage: str, now: Observation) -> Strategy | None:
        """Handle a cost that could not be evaluated; return a new strategy, or None to give up."""
        return None

    def on_end(self, reason: str) -> None:
        """Handle the end of the episode: "success", or the reason of the failure."""
        return


class FixedStrategist(Strategist):
    """Follows one given strategy to the end, with its author's beliefs about masses and frictions."""

    counts = StrategistCounts()

    def __init__(self, strategy: Strategy) -> None:
        self._strategy = strategy

    def begin(self, trial: Trial, first: Observation, world: PlanningWorld) -> Strategy:
        """See `Strategist.begin`."""
        world.believe(stated_beliefs(trial))
        return self._strategy
