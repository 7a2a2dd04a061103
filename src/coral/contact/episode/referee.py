"""Who judges an episode: the simulator's truth, the robot's own perception, or a person beside the robot."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

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


class Referee:
    """Judges an episode, one call of each method at every control step.

    The `judge` judges by the conditions of the task; None leaves the verdict to the operator. Without the `truth` it
    judges by the measured poses, with their errors.
    """

    def __init__(
        self,
        name: JudgedBy,
        judge: Judge | None,
        truth: Callable[[], Truth] | None = None,
        operator_verdict: OperatorVerdict = lambda: "",
    ) -> None:
        self.name, self._judge, self._truth, self._ask = name, judge, truth, operator_verdict

    @property
    def holding(self) -> tuple[bool, ...]:
        """Return which conditions of the task hold; empty if they are not checked."""
        return () if self._judge is None else self._judge.holding

    def judged_state(self, now: Observation) -> Truth:
        """Return the state that is judged and recorded."""
        return measured_state(now) if self._truth is None else self._truth()

    def end_reason(self, state: Truth, time_left: bool) -> str:
        """Return why the episode ends; "" while it continues."""
        reason = "" if time_left else "timeout"
        if self._judge is None:
            said = self._ask()
            return {"success": "success", "failure": "operator-failure"}.get(said, reason)
        found = end_reason(self._judge, state, time_left)
        # Real bodies do not pass through each other; a wrong pose does.
        return reason if self._truth is None and found.startswith("tunnelling") else found


def make_referee(
    judged_by: JudgedBy, world: RobotWorld, trial: Trial, operator_verdict: OperatorVerdict | None = None
) -> Referee:
    """Make the referee of an episode.

    Poses do not tell who touches whom. Leaving out the conditions that read contacts would let other states pass (a box
    that was never lifted is upright and still), so perception refuses a task with such a condition.

    Raises:
        InputError: This referee cannot judge this task in this world.
    """
    if judged_by == "truth":
        if not isinstance(world, TruthfulWorld):
            expected = f"perception or operator: the world {world.name!r} does not know the truth"
            raise InputError("--cfg", "judged-by", "truth", expected)
        return Referee("truth", Judge(trial), world.truth)
    if judged_by == "perception":
        for condition in trial.task.success.conditions:
            if condition.reads_contacts:
                expected = f"operator or truth: poses do not tell whether the condition {condition.kind!r} holds"
                raise InputError("--cfg", "judged-by", "perception", expected)
        return Referee("perception", Judge(trial))
    if operator_verdict is None:
        raise InputError("--cfg", "judged-by", "operator", "truth or perception: this command cannot ask an operator")
    return Referee("operator", None, operator_verdict=operator_verdict)


def measured_state(now: Observation) -> Truth:
    """Return the measured state in the form that judge and record read; contacts are unknown."""
    return Truth(now.time_s, now.tool, now.opening_m, now.objects, (), contacts_known=False)
