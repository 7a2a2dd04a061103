"""Reading what was recorded: the attempts of an earlier run, or of a recording that comes with the package."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from coral.advisor.question import AdvisorUnavailable, BadAnswer, Question, Reply, Usage
from coral.errors import InputError, shown
from coral.foreign_file import parse_json, regular_bytes
from coral.limits import LOG_BYTES
from coral.run_files import RunFiles

A = TypeVar("A", bound=BaseModel)

SHIPPED = Path(__file__).with_name("recordings")
"""Recordings that come with the package; its README says of whom."""

KEY_PARTS = {
    "kind": "kind",
    "prompt_version": "prompt version",
    "schema": "answer schema",
    "pictures": "pictures",
    "facts_digest": "facts",
    "prompt_digest": "prompt",
}
"""Parts of a question's key, the coarsest first, and how to call them."""

Seconds = Annotated[float, Field(ge=0, le=1e9)]
Tokens = Annotated[int, Field(ge=0, le=10**15)]


class _Usage(BaseModel):
    """What `Usage` is made of."""

    model_config = ConfigDict(extra="forbid", strict=True)

    input_tokens: Tokens = 0
    output_tokens: Tokens = 0
    cost_usd: Annotated[float, Field(ge=0, le=1e9)] | None = 0.0
    requests: Tokens = 1
    faults: list[str] = Field(default_factory=list)


class _Entry(BaseModel):
    """What has to be right of a recorded attempt before any of it is repeated."""

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


Attempted = dict[str, Any]
"""A line of attempts.jsonl, checked."""


def find_recording(name: str) -> Path:
    """The file of a recording: attempts.jsonl, a run folder that holds one, or the name of a shipped recording.

    What lies at that path comes first.
    """
    file = Path(name)
    if file.is_dir():
        return file / RunFiles.ATTEMPTS
    if not file.exists() and name in shipped_recordings():
        return SHIPPED / f"{name}.jsonl"
    return file


def shipped_recordings() -> list[str]:
    """Names of the recordings that come with the package."""
    return sorted(file.stem for file in SHIPPED.glob("*.jsonl"))


def repeat(entry: Attempted, question: Question[A], file: Path) -> Reply[A]:
    """Return a recorded reply as the answer to a question.

    Raises:
        BadAnswer, AdvisorUnavailable: As recorded, or with code "not-recorded" if the answer no longer validates.
    """
    latency_s = entry["answered_at_s"] - entry["asked_at_s"]
    usage = Usage(**{**entry["usage"], "faults": tuple(entry["usage"].get("faults", ()))})
    verdict, code, reason, raw = entry["verdict"], entry["code"], entry["reason"], entry["raw"]
    if verdict == "malformed":
        raise BadAnswer(code, reason, raw, usage, latency_s)
    if never_came(entry):
        # The mission's own deadline or withdrawal ends it again.
        raise AdvisorUnavailable("silence", "no reply was recorded", latency_s=math.inf)
    if verdict == "unavailable":
        raise AdvisorUnavailable(code, reason, final=entry["final"], latency_s=latency_s, usage=usage)
    try:
        value = question.answer_type.model_validate(entry["answer"])
    except ValidationError as error:
        raise AdvisorUnavailable(
            "not-recorded", f"{file}: a recorded answer no longer validates: {error}", final=True, latency_s=0.0
        ) from None
    return Reply(value=value, raw=raw, usage=usage, latency_s=latency_s)


def never_came(entry: Attempted) -> bool:
    """Whether the run did not wait for a reply."""
    return bool(entry["verdict"] == "withdrawn" or (entry["verdict"] == "unavailable" and entry["code"] == "deadline"))


def read_attempts(file: Path, where: str) -> list[Attempted]:
    """Read all attempts, of a file that `find_recording` returns, for which an advisor was really asked.

    Raises:
        InputError: There is no such file, or a line is not an attempt.
    """
    # With the deadline past already no advisor was asked, and none will be.
    return [
        entry
        for entry in _read(file, where)
        if not (entry["code"] == "deadline" and entry["asked_at_s"] == entry["answered_at_s"])
    ]


def _read(file: Path, where: str) -> list[Attempted]:
    try:
        lines = regular_bytes(file, LOG_BYTES)[:LOG_BYTES].decode().splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            where,
            "replay",
            f"{file}: {getattr(error, 'strerror', None) or error}",
            f"a run folder, its attempts.jsonl, or one of {', '.join(shipped_recordings())}",
        ) from None
    entries = []
    wanted = {*KEY_PARTS, "asked_at_s", "answered_at_s", "verdict", "code", "reason", "raw", "answer", "usage", "final"}
    for number, line in enumerate(lines, start=1):
        try:
            entry = parse_json(line)
        except ValueError:
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
