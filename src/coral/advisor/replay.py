"""An advisor that repeats a recording, answer by answer: to the same questions, or in their order to any."""

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
from coral.advisor.recorded_attempts import KEY_PARTS, Attempted, find_recording, never_came, read_attempts, repeat
from coral.advisor.setting import Setting

A = TypeVar("A", bound=BaseModel)


class ReplayAdvisor:
    """Answers from the attempts.jsonl of an earlier run.

    A question is found by its kind, prompt version, answer schema, picture digests and prompt digest. If it was asked
    several times, the recorded replies are repeated in order: same questions, same answers, same failures, same
    latencies. So no question is answered that has changed by a word.

    In order, a question gets the next recorded reply to a question of its kind, whatever it shows: recorded answers are
    tried in the package as it is now. Each is checked anew, and a refused one is followed by the next. It reacts to
    nothing, so its run is not what the recorded advisor would have done. Replies for which the run did not wait are
    left out.
    """

    latency = "recorded"
    source: Source = "recording"

    def __init__(
        self, recording: Path | str, where: str = "--advisor", *, in_order: bool = False, accepted: bool = False
    ) -> None:
        """Read attempts.jsonl, a run folder that holds one, or a shipped recording by its name.

        Questions of a kind may be answered in the order of the recording; with `accepted`, answers that were refused
        then are left out.

        Raises:
            InputError: There is no such file, or a line is not an attempt.
        """
        self._file, self._in_order = find_recording(str(recording)), in_order
        self.name = f"{'in-order' if in_order else 'replay'}:{recording}"
        self._recorded: dict[str, deque[Attempted]] = {}
        self._keys: list[dict[str, Any]] = []
        for entry in read_attempts(self._file, where):
            if (in_order and never_came(entry)) or (accepted and entry["verdict"] != "accepted"):
                continue
            key = {part: entry[part] for part in KEY_PARTS}
            if self._place(key) not in self._recorded:
                self._keys.append(key)
            self._recorded.setdefault(self._place(key), deque()).append(entry)

    def _place(self, key: dict[str, Any]) -> str:
        return str(key["kind"]) if self._in_order else json.dumps(key, sort_keys=True)

    def answer(self, question: Question[A], rejections: Sequence[Rejection]) -> Coroutine[Any, Any, Reply[A]]:
        """Repeat the recorded answer to this question.

        The recording advances here, before the first await, so that a question withdrawn at once counts too.

        Raises:
            BadAnswer, AdvisorUnavailable: As recorded, or with code "not-recorded" if the question is not there.
        """
        key = question_key(question)
        queue = self._recorded.get(self._place(key))
        return self._repeat(question, key, queue.popleft() if queue else None, known=queue is not None)

    async def _repeat(
        self, question: Question[A], key: dict[str, Any], entry: Attempted | None, *, known: bool
    ) -> Reply[A]:
        if entry is None:
            raise AdvisorUnavailable("not-recorded", self._explain_missing(key, known), final=True, latency_s=0.0)
        return repeat(entry, question, self._file)

    def _explain_missing(self, key: dict[str, Any], known: bool) -> str:
        """Explain why a question is not in the recording, by comparison with the nearest one that is."""
        if self._in_order:
            return f"{self._file}: no answer to a {key['kind']} question is left"
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
    """Make the advisor of a recording, replay:FILE or in-order:FILE.

    Raises:
        InputError: The file is missing or unreadable.
    """
    return ReplayAdvisor(rest, where=setting.where, in_order=name == "in-order")
