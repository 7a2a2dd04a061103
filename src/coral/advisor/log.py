"""The attempt log on disk: attempts.jsonl, one line per attempt, and each picture once by its digest."""

from __future__ import annotations

import contextlib
import dataclasses
import hashlib
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from coral.advisor.consult import Attempt
from coral.advisor.question import Question
from coral.errors import naming
from coral.file_writer import open_log, write_whole
from coral.odd_text import encodable
from coral.run_files import RunFiles

RAW_LIMIT = 65_536
"""Characters of a raw reply that are kept."""


def question_key(question: Question[Any]) -> dict[str, Any]:
    """Return the identity of a question as JSON: the key of a recording.

    Facts count only without pictures, because then nothing else distinguishes states of the world. Digests are SHA-256,
    hexadecimal; that of the answer's schema is independent of key order.
    """
    return {
        "kind": question.kind,
        "prompt_version": question.prompt_version,
        "schema": _digest(json.dumps(question.answer_type.model_json_schema(), sort_keys=True)),
        "prompt_digest": _digest(question.prompt),
        "pictures": [picture.digest for picture in question.pictures],
        "facts_digest": "" if question.pictures else _digest(plain_json(question.facts)),
    }


def attempt_to_json(attempt: Attempt) -> dict[str, Any]:
    """Convert an attempt to one line of attempts.jsonl, with its pictures by digest."""
    rejection = attempt.rejection
    question = attempt.question
    return {
        "decision": attempt.decision,
        "attempt": attempt.attempt,
        "asked_at_s": attempt.asked_at_s,
        "answered_at_s": attempt.answered_at_s,
        **question_key(question),
        "verdict": attempt.verdict,
        "code": rejection.code if rejection else "",
        "reason": rejection.reason if rejection else "",
        "details": dict(rejection.details) if rejection else {},
        "final": attempt.final,
        "answer": attempt.answer,
        "raw": attempt.raw[:RAW_LIMIT],
        "raw_chars": len(attempt.raw),
        "usage": dataclasses.asdict(attempt.usage),
        "prompt": question.prompt,
        "captions": [[picture.name, picture.caption] for picture in question.pictures],
        "facts": dict(question.facts),
    }


class AttemptRecorder:
    """Appends attempts to `folder/attempts.jsonl`, and new pictures to `folder/pictures/<digest>.png`.

    Every line is flushed, so that the questions and replies of a killed run can be read and replayed.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder / RunFiles.PICTURES
        self._seen: set[str] = set()
        folder.mkdir(parents=True, exist_ok=True)
        self._file = open_log(folder / RunFiles.ATTEMPTS)

    def __call__(self, attempt: Attempt) -> None:
        """Append one attempt; pass the recorder itself as `consult`'s `log`."""
        for picture in attempt.question.pictures:
            digest = picture.digest
            if digest not in self._seen:
                write_whole(self._folder / f"{digest}.png", picture.png)
                self._seen.add(digest)
        with naming(Path(self._file.name)):
            self._file.write(plain_json(attempt_to_json(attempt)) + "\n")

    def close(self) -> None:
        """Close the log; an error of a full disk was reported at the time of writing."""
        with contextlib.suppress(OSError):
            self._file.close()


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def plain_json(value: Any, indent: int | None = None) -> str:
    """Encode a value as JSON, NumPy's numbers included; non-finite ones become null, lone surrogates U+FFFD."""
    return json.dumps(_plain(value), allow_nan=False, indent=indent)


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {encodable(str(key)): _plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if value is None or isinstance(value, int | bool) else encodable(str(value))
