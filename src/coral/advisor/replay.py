"""Advisors that repeat a recording, answer by answer: to the same questions, in their order to any, or by task."""

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
from coral.advisor.recorded_attempts import (
    KEY_PARTS,
    SHIPPED,
    Attempted,
    find_recording,
    never_came,
    read_attempts,
    repeat,
    shipped_recordings,
)
from coral.advisor.setting import Setting
from coral.errors import InputError

A = TypeVar("A", bound=BaseModel)
CONTACT, UNIFIED, UNGUIDED = "contact-", "unified-", "unguided-"
"""Beginnings of the names of shipped recordings of contact tasks; the last two are of the variants of these names."""
POSES = "poses"
"""The recording of answers about pictures: each serves the trial whose picture it is about, and no other."""


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


class RecordedAdvisor:
    """Answers with what a vision-language model answered at the desk for the task that the question names.

    A plan is a program over quantities, so one recording serves every trial of its task, whatever its poses, sizes and
    masses; a repair is given where one is asked for. One question for everything, and plans without a contact strategy,
    have recordings of their own. There is nothing for a task that nobody answered, nor for a picture (`no-tracking`)
    that nobody read.
    """

    latency = "recorded"
    source: Source = "recording"
    name = "recorded"

    def __init__(self) -> None:
        self._recordings: dict[str, ReplayAdvisor] = {}
        self._asked = CONTACT

    async def answer(self, question: Question[A], rejections: Sequence[Rejection]) -> Reply[A]:
        """Give the next recorded answer of the question's kind.

        Raises:
            AdvisorUnavailable: With code "not-recorded": there is none, or none is left.
        """
        if question.kind == "object-poses":
            if POSES not in self._recordings:
                self._recordings[POSES] = ReplayAdvisor(SHIPPED / f"{POSES}.jsonl")
            return await self._recordings[POSES].answer(question, rejections)
        task = str(question.facts.get("task", ""))
        if question.kind == "unified":
            self._asked = UNIFIED
        elif not question.facts.get("contact_strategy", True):
            self._asked = UNGUIDED
        name = f"{self._asked}{task}"
        if name not in shipped_recordings():
            raise AdvisorUnavailable("not-recorded", f"nobody answered {task!r} yet", final=True, latency_s=0.0)
        if name not in self._recordings:
            self._recordings[name] = ReplayAdvisor(SHIPPED / f"{name}.jsonl", in_order=True, accepted=True)
        return await self._recordings[name].answer(question, rejections)


def is_recorded(task: str, variant: str = "full") -> bool:
    """Return whether a recording of a contact task comes with the package; `unified` and `unguided` have their own."""
    own = f"{variant}-"
    return f"{own if own in (UNIFIED, UNGUIDED) else CONTACT}{task}" in shipped_recordings()


def make_recorded(name: str, rest: str, setting: Setting) -> RecordedAdvisor:
    """Make the advisor of the shipped recordings of contact tasks.

    Raises:
        InputError: The application has reefs alone.
    """
    if setting.rules and all(kind.startswith("reef-") for kind in setting.rules):
        reefs = [name for name in shipped_recordings() if name.startswith("reef-")]
        expected = f"for a reef a recorded mission, such as in-order:{reefs[0]}: {name} holds answers to contact tasks"
        raise InputError(setting.where, "", name, expected)
    return RecordedAdvisor()
