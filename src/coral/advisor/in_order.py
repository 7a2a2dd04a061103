"""An advisor that gives recorded answers in their order, also to questions that have changed since."""

from __future__ import annotations

from collections import deque
from collections.abc import Coroutine, Sequence
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel

from coral.advisor.attribution import Source
from coral.advisor.question import AdvisorUnavailable, Question, Rejection, Reply
from coral.advisor.recorded_attempts import Attempted, find_recording, never_came, read_attempts, repeat
from coral.advisor.setting import Setting

A = TypeVar("A", bound=BaseModel)


class InOrderAdvisor:
    """Answers a question with the next recorded reply to a question of its kind, whatever the question shows.

    `ReplayAdvisor` repeats a run and answers no question that has changed by a word. This one tries recorded answers
    in the package as it is now: each is checked anew, and a refused one is followed by the next. It reacts to nothing,
    so its run is not what the recorded advisor would have done. Replies for which the run did not wait are left out.
    """

    latency = "recorded"
    source: Source = "recording"

    def __init__(self, recording: Path | str, where: str = "--advisor") -> None:
        """Read a recording.

        Args:
            recording: attempts.jsonl, a run folder that holds one, or a shipped recording's name.
            where: What to name in an error message.

        Raises:
            InputError: There is no such file, or a line is not an attempt.
        """
        self._file = find_recording(str(recording))
        self.name = f"in-order:{recording}"
        self._left: dict[str, deque[Attempted]] = {}
        for entry in read_attempts(self._file, where):
            if not never_came(entry):
                self._left.setdefault(entry["kind"], deque()).append(entry)

    def answer(self, question: Question[A], rejections: Sequence[Rejection]) -> Coroutine[Any, Any, Reply[A]]:
        """Give the next recorded reply.

        Raises:
            BadAnswer, AdvisorUnavailable: As recorded, or with code "not-recorded" when none of its kind is left.
        """
        queue = self._left.get(question.kind)
        return self._give(question, queue.popleft() if queue else None)

    async def _give(self, question: Question[A], entry: Attempted | None) -> Reply[A]:
        if entry is None:
            reason = f"{self._file}: no answer to a {question.kind} question is left"
            raise AdvisorUnavailable("not-recorded", reason, final=True, latency_s=0.0)
        return repeat(entry, question, self._file)


def make_in_order(name: str, rest: str, setting: Setting) -> InOrderAdvisor:
    """Make the advisor of a recording, in-order:FILE.

    Raises:
        InputError: The file is missing or unreadable.
    """
    return InOrderAdvisor(rest, where=setting.where)
