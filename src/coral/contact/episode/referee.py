"""Who judges an episode: the simulator's truth, the robot's own perception, or a person beside the robot."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal, Protocol

from coral.contact.episode.trial_log import end_reason
from coral.contact.scene.judge import Judge
from coral.contact.scene.observation import Observation, Truth
from coral.contact.scene.trial import Trial
from coral.contact.worlds.evaluation_world import TruthfulWorld
from coral.contact.worlds.robot_world import RobotWorld
from coral.errors import InputError

JudgedBy = Literal["truth", "perception", "operator"]
"""Names of the referees."""
OperatorVerdict = Callable[[], Literal["success", "failure", ""]]
"""Returns what the operator has said about the present episode; "" before that. It must not wait."""


class Referee(Protocol):
    """Judges an episode, one call of each method at every control step.

    Attributes:
        name: Name for records.
    """

    name: JudgedBy

    @property
    def holding(self) -> tuple[bool, ...]:
        """Return which conditions of the task hold; empty if they are not checked."""
        ...

    def judged_state(self, now: Observation) -> Truth:
        """Return the state that is judged and recorded."""
        ...

    def end_reason(self, state: Truth, time_left: bool) -> str:
        """Return why the episode ends; "" while it continues."""
        ...


def make_referee(
    judged_by: JudgedBy, world: RobotWorld, trial: Trial, operator_verdict: OperatorVerdict | None
) -> Referee:
    """Make the referee of an episode.

    Args:
        judged_by: The configured referee.
        world: The world of the episode.
        trial: The trial.
        operator_verdict: Asks the operator; None if there is no operator.

    Raises:
        InputError: This referee cannot judge this task in this world.
    """
    if judged_by == "truth":
        if not isinstance(world, TruthfulWorld):
            expected = f"perception or operator: the world {world.name!r} does not know the truth"
            raise InputError("--cfg", "judged-by", "truth", expected)
        return TruthReferee(world, trial)
    if judged_by == "perception":
        return PerceptionReferee(trial)
    if operator_verdict is None:
        raise InputError("--cfg", "judged-by", "operator", "truth or perception: this command cannot ask an operator")
    return OperatorReferee(operator_verdict)


class TruthReferee:
    """Judges by the true state of a simulation."""

    name: JudgedBy = "truth"

    def __init__(self, world: TruthfulWorld, trial: Trial) -> None:
        self._world, self._judge = world, Judge(trial)

    @property
    def holding(self) -> tuple[bool, ...]:
        """See `Referee.holding`."""
        return self._judge.holding

    def judged_state(self, now: Observation) -> Truth:
        """See `Referee.judged_state`."""
        return self._world.truth()

    def end_reason(self, state: Truth, time_left: bool) -> str:
        """See `Referee.end_reason`."""
        return end_reason(self._judge, state, time_left)


class PerceptionReferee:
    """Judges by measured poses, with their errors.

    Poses do not tell who touches whom. Leaving out the conditions that read contacts would let other states pass (a box
    that was never lifted is upright and still), so a task with such a condition is refused.

    Raises:
        InputError: A condition of the task reads contacts.
    """

    name: JudgedBy = "perception"

    def __init__(self, trial: Trial) -> None:
        for condition in trial.task.success.conditions:
            if condition.reads_contacts:
                expected = f"operator or truth: poses do not tell whether the condition {condition.kind!r} holds"
                raise InputError("--cfg", "judged-by", "perception", expected)
        self._judge = Judge(trial)

    @property
    def holding(self) -> tuple[bool, ...]:
        """See `Referee.holding`."""
        return self._judge.holding

    def judged_state(self, now: Observation) -> Truth:
        """See `Referee.judged_state`."""
        return measured_state(now)

    def end_reason(self, state: Truth, time_left: bool) -> str:
        """See `Referee.end_reason`."""
        reason = end_reason(self._judge, state, time_left)
        if reason.startswith("tunnelling"):  # real bodies do not; a wrong pose does
            return "" if time_left else "timeout"
        return reason


class OperatorReferee:
    """Leaves the verdict to a person."""

    name: JudgedBy = "operator"

    def __init__(self, operator_verdict: OperatorVerdict) -> None:
        self._ask = operator_verdict

    @property
    def holding(self) -> tuple[bool, ...]:
        """See `Referee.holding`."""
        return ()

    def judged_state(self, now: Observation) -> Truth:
        """See `Referee.judged_state`."""
        return measured_state(now)

    def end_reason(self, state: Truth, time_left: bool) -> str:
        """See `Referee.end_reason`."""
        said = self._ask()
        if said:
            return "success" if said == "success" else "operator-failure"
        return "" if time_left else "timeout"


def measured_state(now: Observation) -> Truth:
    """Return the measured state in the form that judge and record read; contacts are unknown."""
    return Truth(now.time_s, now.tool, now.opening_m, now.objects, (), contacts_known=False)
