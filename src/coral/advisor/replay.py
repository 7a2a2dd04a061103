"""An advisor that repeats a recording: same questions, same answers, same failures, same latencies."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Coroutine, Sequence
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel

from coral.advisor.attribution import Source
from coral.advisor.log import question_key
from coral.advisor.question import AdvisorUnavailable, Question, Rejection, Reply
from coral.advisor.recorded_attempts import KEY_PARTS, Attempted, find_recording, read_attempts, repeat
from coral.advisor.setting import Setting

A = TypeVar("A", bound=BaseModel)


class ReplayAdvisor:
    """Answers from the attempts.jsonl of an earlier run.

    A question is found by its kind, prompt version, answer schema, picture digests and prompt digest. If it was asked
    several times, the recorded replies are repeated in order.
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
        self.name = f"replay:{recording}"
        self._keys: list[dict[str, Any]] = []
        self._recorded: dict[str, deque[Attempted]] = {}
        for entry in read_attempts(self._file, where):
            key = {part: entry[part] for part in KEY_PARTS}
            text = json.dumps(key, sort_keys=True)
            if text not in self._recorded:
                self._keys.append(key)
            self._recorded.setdefault(text, deque()).append(entry)

    def answer(self, question: Question[A], rejections: Sequence[Rejection]) -> Coroutine[Any, Any, Reply[A]]:
        """Repeat the recorded answer to this question.

        The recording advances here, before the first await, so that a question withdrawn at once counts too.

        Raises:
            BadAnswer, AdvisorUnavailable: As recorded, or with code "not-recorded" if the question is not there.
        """
        key = question_key(question)
        queue = self._recorded.get(json.dumps(key, sort_keys=True))
        entry = queue.popleft() if queue else None
        return self._repeat(question, key, entry, known=queue is not None)

    async def _repeat(
        self, question: Question[A], key: dict[str, Any], entry: Attempted | None, *, known: bool
    ) -> Reply[A]:
        if entry is None:
            raise AdvisorUnavailable("not-recorded", self._explain_missing(key, known), final=True, latency_s=0.0)
        return repeat(entry, question, self._file)

    def _explain_missing(self, key: dict[str, Any], known: bool) -> str:
        """Explain why a question is not in the recording, by comparison with the nearest one that is."""
        if known:
            return f"{self._file}: this {key['kind']} question was asked more often than when it was recorded"
        if not self._keys:
            return f"{self._file}: the recording is empty"

        def same(other: dict[str, Any]) -> tuple[bool, ...]:
            return tuple(other[part] == key[part] for part in KEY_PARTS)

        nearest = max(self._keys, key=same)
        if nearest["kind"] != key["kind"]:
            kinds = ", ".join(sorted({k["kind"] for k in self._keys}))
            return f"{self._file}: no question of kind {key['kind']!r} was recorded, only {kinds}"
        different = []
        for part, label in KEY_PARTS.items():
            if nearest[part] != key[part]:
                versions = f" ({key[part]} now, {nearest[part]} recorded)" if part == "prompt_version" else ""
                different.append(label + versions)
        return (
            f"{self._file}: this {key['kind']} question was not recorded; the nearest one differs in "
            f"{', '.join(different)}"
        )


def make_replay(name: str, rest: str, setting: Setting) -> ReplayAdvisor:
    """Make the advisor of a recording, replay:FILE.

    Raises:
        InputError: The file is missing or unreadable.
    """
    return ReplayAdvisor(rest, where=setting.where)
