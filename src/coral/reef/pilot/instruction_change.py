"""An instruction that a person changes while a mission in words is under way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from coral.reef.decide.mission_planner import MissionPlanner
from coral.reef.decide.planner import HighLevelPlanner
from coral.reef.decide.trigger import Firing
from coral.reef.world.instruction import checked_words


class InstructionChange:
    """Keeps new words until the next tick takes them over, and knows whether a question has carried them."""

    def __init__(self) -> None:
        self.unasked = False
        """Whether the instruction was changed since the last question."""
        self._told: tuple[str, str] | None = None

    def tell(self, planner: HighLevelPlanner, words: str, by: str) -> bool:
        """Take new words, from any thread. Return whether the planner has an instruction to change.

        Raises:
            InputError: They are empty or too long.
        """
        if not isinstance(planner, MissionPlanner):
            return False
        self._told = checked_words(words, by), by
        return True

    def take(self, planner: HighLevelPlanner, emit: Callable[..., None]) -> bool:
        """Give the planner the words that were told since the last tick. Return whether there were any."""
        if self._told is None or not isinstance(planner, MissionPlanner):
            return False
        (words, by), self._told = self._told, None
        planner.instruct(words)
        emit("instruction", text=words, by=by)
        self.unasked = True
        return True

    def asked(self) -> None:
        """Note that a question carries the words."""
        self.unasked = False

    def cause(self, firing: Firing | None) -> Firing | None:
        """Return a firing with the change as its cause, where only the change has brought it on."""
        changed = self.unasked and firing is not None and firing.cause == "distance"
        return replace(firing, cause="instruction") if firing is not None and changed else firing
