"""An advisor that repeats a recording: same questions, same answers, same failures, same latencies."""

from __future__ import annotations

import json
import math
from collections import deque
from collections.abc import Coroutine, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from coral.advisor.attribution import Source
from coral.advisor.log import question_key
from coral.advisor.question import AdvisorUnavailable, BadAnswer, Question, Rejection, Reply, Usage
from coral.errors import InputError
from coral.validation_errors import shown
from coral.yaml_file import regular_bytes

if TYPE_CHECKING:
    from coral.advisor.setting import Setting

A = TypeVar("A", bound=BaseModel)

_PARTS = {
    "kind": "kind",
    "prompt_version": "prompt version",
    "schema": "answer schema",
    "pictures": "pictures",
    "facts_digest": "facts",
    "prompt_digest": "prompt",
}
"""Parts of a question's key, the coarsest first, and their names in messages."""


MAX_BYTES = 1_000_000_000
"""Maximum size of a recording; the rest is not read."""

Seconds = Annotated[float, Field(ge=0, le=1e9)]
Tokens = Annotated[int, Field(ge=0, le=10**15)]


class _Usage(BaseModel):
    """Schema of a recorded `Usage`."""

    model_config = ConfigDict(extra="forbid", strict=True)

    input_tokens: Tokens = 0
    output_tokens: Tokens = 0
    cost_usd: Annotated[float, Field(ge=0, le=1e9)] | None = 0.0
    requests: Tokens = 1
    faults: list[str] = Field(default_factory=list)


class _Entry(BaseModel):
    """Schema of a recorded attempt; nothing is repeated before all of them validate."""

    model_config = ConfigDict(strict=True)

    kind: str
    prompt_version: str
    schema_digest: str = Field(alias="schema")
    pictures: list[str]
    facts_digest: str
    prompt_digest: str
    asked_at_s: Seconds
    answered_at_s: Seconds
    verdict: Literal["accepted", "rejected", "malformed", "unavailable", "withdrawn"]
    code: str
    reason: str
    raw: str
    usage: _Usage
    final: bool

    @model_validator(mode="after")
    def _in_order(self) -> _Entry:
        if self.answered_at_s < self.asked_at_s:
            raise ValueError("an answer after its question")
        return self


class ReplayAdvisor:
    """Answers from the attempts.jsonl of an earlier run.

    A question is found by its kind, prompt version, answer schema, picture digests and prompt digest. If it was asked
    several times, the recorded replies are repeated in order.
    """

    latency = "recorded"
    source: Source = "recording"

    def __init__(self, file: Path, where: str = "--advisor") -> None:
        """Read a recording.

        Args:
            file: attempts.jsonl, or a run folder with one.
            where: Flag to name in an error message.

        Raises:
            InputError: There is no such file, or a line is not an attempt.
        """
        self._file = file / "attempts.jsonl" if file.is_dir() else file
        self.name = f"replay:{file}"
        self._keys: list[dict[str, Any]] = []
        self._recorded: dict[str, deque[dict[str, Any]]] = {}
        for entry in _read(self._file, where):
            if entry["code"] == "deadline" and entry["asked_at_s"] == entry["answered_at_s"]:
                continue  # The deadline had already passed: no advisor was asked, and none will be.
            key = {part: entry[part] for part in _PARTS}
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
        self, question: Question[A], key: dict[str, Any], entry: dict[str, Any] | None, *, known: bool
    ) -> Reply[A]:
        if entry is None:
            raise AdvisorUnavailable("not-recorded", self._explain_missing(key, known), final=True, latency_s=0.0)
        latency_s = entry["answered_at_s"] - entry["asked_at_s"]
        usage = Usage(**{**entry["usage"], "faults": tuple(entry["usage"].get("faults", ()))})
        verdict, code, reason, raw = entry["verdict"], entry["code"], entry["reason"], entry["raw"]
        if verdict == "malformed":
            raise BadAnswer(code, reason, raw, usage, latency_s)
        if verdict == "withdrawn" or (verdict == "unavailable" and code == "deadline"):
            # No reply ever came: the mission's own deadline or withdrawal ends the question again.
            raise AdvisorUnavailable("silence", "no reply was recorded", latency_s=math.inf)
        if verdict == "unavailable":
            raise AdvisorUnavailable(code, reason, final=entry["final"], latency_s=latency_s, usage=usage)
        try:
            value = question.answer_type.model_validate(entry["answer"])
        except ValidationError as error:
            raise AdvisorUnavailable(
                "not-recorded",
                f"{self._file}: a recorded answer no longer validates: {error}",
                final=True,
                latency_s=0.0,
            ) from None
        return Reply(value=value, raw=raw, usage=usage, latency_s=latency_s)

    def _explain_missing(self, key: dict[str, Any], known: bool) -> str:
        """Explain why a question is not in the recording, by comparison with the nearest one that is."""
        if known:
            return f"{self._file}: this {key['kind']} question was asked more often than when it was recorded"
        if not self._keys:
            return f"{self._file}: the recording is empty"

        def same(other: dict[str, Any]) -> tuple[bool, ...]:
            return tuple(other[part] == key[part] for part in _PARTS)

        nearest = max(self._keys, key=same)
        if nearest["kind"] != key["kind"]:
            kinds = ", ".join(sorted({k["kind"] for k in self._keys}))
            return f"{self._file}: no question of kind {key['kind']!r} was recorded, only {kinds}"
        different = []
        for part, label in _PARTS.items():
            if nearest[part] != key[part]:
                versions = f" ({key[part]} now, {nearest[part]} recorded)" if part == "prompt_version" else ""
                different.append(label + versions)
        return (
            f"{self._file}: this {key['kind']} question was not recorded; the nearest one differs in "
            f"{', '.join(different)}"
        )


def _read(file: Path, where: str) -> list[dict[str, Any]]:
    try:
        lines = regular_bytes(file, MAX_BYTES)[:MAX_BYTES].decode().splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            where,
            "replay",
            f"{file}: {getattr(error, 'strerror', None) or error}",
            "a run folder, or its attempts.jsonl",
        ) from None
    entries = []
    wanted = {*_PARTS, "asked_at_s", "answered_at_s", "verdict", "code", "reason", "raw", "answer", "usage", "final"}
    for number, line in enumerate(lines, start=1):
        try:
            entry = json.loads(line)
        except (ValueError, RecursionError):
            if number == len(lines):
                break  # The run was killed while it wrote this line.
            raise InputError(str(file), f"line {number}", "no JSON", "one attempt per line") from None
        missing = wanted - set(entry) if isinstance(entry, dict) else wanted
        if missing:
            raise InputError(str(file), f"line {number}", f"no {', '.join(sorted(missing))}", "an attempt")
        try:
            _Entry.model_validate(entry)
        except ValidationError as error:
            fault = error.errors()[0]
            field = ".".join(map(str, fault["loc"]))
            expected = fault["msg"].removeprefix("Input should be ")
            raise InputError(str(file), f"line {number}: {field}", shown(fault["input"]), expected) from None
        entries.append(entry)
    return entries


def make_replay(name: str, rest: str, setting: Setting) -> ReplayAdvisor:
    """Make the advisor of a recording, replay:FILE.

    Raises:
        InputError: The file is missing or unreadable.
    """
    return ReplayAdvisor(Path(rest), where=setting.where)
