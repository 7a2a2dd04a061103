"""What every high-level planner has: its configuration, its route, and questions as values (paper III-C)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from coral.advisor.question import Picture, Question, Rejection
from coral.config import Count, NonNegative
from coral.reef.decide.answers import CentroidAnswer, WaypointAnswer
from coral.reef.decide.guesses import Guess
from coral.reef.decide.outlook import Outlook
from coral.reef.decide.route import Arrival, Goal, Route, RouteCfg, here
from coral.reef.decide.survey import Survey, SurveyCfg
from coral.reef.decide.topology import Remaining, RemainingTour
from coral.reef.decide.verify import Surroundings, VerifyCfg
from coral.reef.map.belief import Belief
from coral.reef.map.costfield import CostField, CostFieldCfg

Answer = CentroidAnswer | WaypointAnswer
Draw = Callable[[Outlook], tuple[Picture, ...]]
Mode = Literal["centroid", "waypoint", "mission"]


@dataclass(frozen=True, kw_only=True)
class InstructionCfg:
    """A mission in words."""

    text: str = ""
    """What is to be done; empty: the whole reef is surveyed."""
    time_s: NonNegative = 0.0
    """Time for it, as the advisor gets it; 0: none."""
    clear_m: NonNegative = 2.6
    """The way keeps so far from the middle of what no answer chose, and waypoints lie no nearer: a thing of 0.6 m in
    radius then stays farther than 1.6 m, which counts as inspected, in spite of 0.3 m of drift."""


@dataclass(frozen=True, kw_only=True)
class PlannerCfg:
    """Which planner asks, and what it offers."""

    algorithm: Literal["tour", "paper"] = "tour"
    """paper: Alg. 2. tour: asks ahead, offers all that is left, refuses what is provably wrong, says what others cost.
    Departs from the paper: fixed angles (Eqs. 4-8) refuse right answers, too."""
    forward_m: float = 1.0
    """d_min of Alg. 2: a centroid counts as ahead from this forward projection."""
    step_m: Count = 6
    """Longest waypoint step per axis (paper III-C.2: whole metres, 0 to 6)."""
    separation_m: float = 1.0
    """Delta d_min (paper IV-F): a new goal lies at least this far from the previous one. Departs from the paper: under
    `tour`, from where the robot will be."""
    checks: bool = True
    """False is the ablation "w/o self-verification": only points outside the survey area are refused, which no map
    covers; violations of Eqs. 4-8 are counted, not rejected."""
    centroid_selection: bool = True
    """False is the ablation "w/o centroid selection": the chain is shown, but only waypoints are asked for."""
    explore: bool = True
    """False: unexplored water is no reason to go anywhere, and nothing is left when no unvisited cluster is known.
    Departs from the paper: it has no rule for when a survey is complete."""
    route: RouteCfg = field(default_factory=RouteCfg)
    survey: SurveyCfg = field(default_factory=SurveyCfg)
    verify: VerifyCfg = field(default_factory=VerifyCfg)
    """The paper's check; under `tour` its violations are counted only."""
    finished: bool = True
    """Whether `tour` refuses ways back through finished water. False for lanes that were planned before the dive."""
    topology: bool = True
    """False is the ablation "w/o topological memory": no tour of all that is left. Departs from the paper: it switches
    modes by Alg. 2 alone."""
    instruction: InstructionCfg = field(default_factory=InstructionCfg)
    """With one, questions tell it and `algorithm` is not used. Not in the paper."""


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


class HighLevelPlanner(ABC):
    """Turns what the robot knows into questions, and answers into verified goals."""

    def __init__(self, belief: Belief, fields: CostFieldCfg, draw: Draw, cfg: PlannerCfg | None = None) -> None:
        """Set up the planner of one robot; `draw` draws the pictures of a question."""
        self.belief, self.fields, self.draw = belief, fields, draw
        self.cfg = cfg or PlannerCfg()
        told = self.cfg.instruction
        self.route = Route(belief, self.cfg.route, told.clear_m if told.text else 0.0)
        """The goals that have been decided on."""

    def arrival(self, snapshot: Belief, way: CostField | None) -> Arrival:
        """Return where the robot will be when the answer comes; where it is, without asking ahead."""
        return self.route.arrival(way) if self.cfg.route.ahead else here(snapshot)

    @abstractmethod
    def outlook(self, way: CostField | None = None) -> Outlook:
        """Freeze what the robot knows now, on its `way` to its present goal."""

    @abstractmethod
    def ask(self, outlook: Outlook, rejections: Sequence[Rejection] = ()) -> AskedState:
        """Make a question. It reads nothing but its arguments, so it may run on another thread."""

    @abstractmethod
    def verify(self, asked: AskedState, answer: Answer) -> Rejection | None:
        """Check an answer in the state in which it was asked, and against the map as it is now."""

    @abstractmethod
    def locate(self, asked: AskedState, answer: Answer) -> Goal | Rejection | None:
        """Return the goal that an answer means; None if what it chose has vanished from the map since."""

    def onward(self, asked: AskedState, answer: Answer) -> list[Goal]:
        """Return the goals that an answer names after the first one."""
        return []

    @abstractmethod
    def adopt(self, asked: AskedState, answer: Answer, goal: Goal) -> dict[str, Any]:
        """Take over a choice, and return what the event of its goal tells of it."""

    def settle(self) -> list[Guess]:
        """Return the guesses that have come out since the last call."""
        return []
