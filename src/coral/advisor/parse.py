"""Parsing of an answer from a model's text, without trusting it."""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterator
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from coral.advisor.question import BadAnswer, Usage
from coral.odd_text import encodable, encodable_values

A = TypeVar("A", bound=BaseModel)

MAX_CHARS = 65_536
"""Longer replies are refused unread: an answer has a few hundred characters, and parsing takes the robot's time."""
MAX_DEPTH = 32
"""Maximum nesting of brackets."""
MAX_CANDIDATES = 64
"""Maximum number of bracketed passages of a reply to try, from the last one backwards."""

_FENCE = re.compile(r"```[\w+-]*[ \t]*\r?\n(.*?)```", re.DOTALL)
_TOKEN = re.compile(
    r""""(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*'|[A-Za-z_]\w*|-?\d[\d.]*(?:[eE][+-]?\d+)?|[\s\[\]{}(),:]+""", re.DOTALL
)
_WORDS = {"true": "True", "false": "False", "null": "None", "True": "True", "False": "False", "None": "None"}
_REFUSAL = re.compile(
    r"\b(i['’]?m sorry|i am sorry|i can(?:no|['’])t|i am unable|i['’]m unable|as an ai)\b", re.IGNORECASE
)


def parse_answer(text: str, answer_type: type[A], usage: Usage | None = None) -> A:
    """Find an answer in a reply and validate it.

    Accepted are JSON and Python literals: alone, in a code fence, or surrounded by text. If several passages validate,
    the last one counts: models reason first and answer last. A model class may read its own format: its
    `from_text(text)` class method, if any, returns a value to validate, or None.

    Raises:
        BadAnswer: With code "empty", "too-long", "refusal", "not-json", "missing-field", "wrong-type", "out-of-range"
            or "invalid", and a reason that names the change to make.
    """
    if not text.strip():
        raise BadAnswer("empty", "The reply was empty; answer in the format asked for.", text, usage)
    if len(text) > MAX_CHARS:
        raise BadAnswer(
            "too-long", f"The reply had {len(text)} characters; at most {MAX_CHARS} are read.", text[:MAX_CHARS], usage
        )
    first_error: ValidationError | None = None
    for value in _find_values(encodable(text), answer_type):
        try:
            # JSON may escape a lone surrogate, which no file can contain.
            return _validate(encodable_values(value), answer_type)
        except ValidationError as error:
            first_error = first_error or error
        except RecursionError:
            continue
    if first_error is not None:
        raise BadAnswer(*_explain(first_error), text, usage)
    if _REFUSAL.search(text):
        raise BadAnswer("refusal", "The reply declined to answer; choose one of the options as asked.", text, usage)
    raise BadAnswer(
        "not-json", "No JSON object could be read in the reply; return only the object asked for.", text, usage
    )


def _find_values(text: str, answer_type: type[BaseModel]) -> Iterator[Any]:
    """Find every object or list in the text, the most likely answer first."""
    whole = _read(text.strip())
    if isinstance(whole, dict | list):
        yield whole
        return
    own = getattr(answer_type, "from_text", None)
    if own is not None and (value := own(text)) is not None:
        yield value
    passages = [match.group(1).strip() for match in _FENCE.finditer(text)][::-1]
    passages += [text[start:end] for start, end in _find_bracketed(text)[::-1]]
    for passage in passages[:MAX_CANDIDATES]:
        value = _read(passage)
        if isinstance(value, dict | list):
            yield value


def _find_bracketed(text: str) -> list[tuple[int, int]]:
    """Find the outermost balanced {...} and [...] passages of a text, in order, in one pass.

    Quotes count only inside brackets, and only double ones: an apostrophe in prose opens no string. A bracket that
    never closes hides nothing: its contents are found as well.
    """
    spans: list[tuple[int, int]] = []
    opened: list[int] = []
    in_string = False
    i = 0
    while i < len(text):
        c = text[i]
        if in_string:
            if c == "\\":
                i += 1
            elif c == '"':
                in_string = False
        elif c == '"' and opened:
            in_string = True
        elif c in "{[":
            opened.append(i)
        elif c in "}]" and opened:
            start = opened.pop()
            if (text[start] == "{") == (c == "}"):
                while spans and spans[-1][0] > start:
                    spans.pop()
                spans.append((start, i + 1))
        i += 1
    return spans


def _read(passage: str) -> Any:
    """Parse a passage as JSON or as a Python literal; None if it is neither."""
    if _depth(passage) > MAX_DEPTH:
        return None
    try:
        return json.loads(passage, strict=False)
    except (ValueError, RecursionError):
        pass
    literal = _as_literal(passage)
    if literal is None:
        return None
    try:
        return ast.literal_eval(literal)
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        return None


def _depth(passage: str) -> int:
    """Compute an upper bound on the nesting of a passage (brackets in strings count too)."""
    depth = deepest = 0
    for c in passage:
        if c in "{[(":
            depth += 1
            deepest = max(deepest, depth)
        elif c in "}])":
            depth -= 1
    return deepest


def _as_literal(passage: str) -> str | None:
    """Return the passage as Python source of plain literals, or None if it contains anything else.

    Long chains of operators can crash Python's own parser; this lets no operator through.
    """
    parts: list[str] = []
    at = 0
    while at < len(passage):
        match = _TOKEN.match(passage, at)
        if match is None:
            return None
        token = match.group()
        if token[0] in "\"'":
            token = token.replace("\r", "").replace("\n", "\\n")
        elif token[0].isalpha() or token[0] == "_":
            if token not in _WORDS:
                return None
            token = _WORDS[token]
        parts.append(token)
        at = match.end()
    return " ".join(parts)


def _validate(value: Any, answer_type: type[A]) -> A:
    if isinstance(value, list) and len(value) == 1 and isinstance(value[0], dict):
        try:
            return answer_type.model_validate(value)
        except ValidationError:
            value = value[0]
    return answer_type.model_validate(value)


def _explain(error: ValidationError) -> tuple[str, str]:
    """Return code and reason of the first faults of an answer, in words that a model can act on."""
    faults = error.errors(include_url=False, include_context=False)
    reasons = []
    for fault in faults[:3]:
        field = ".".join(str(part) for part in fault["loc"]) or "the answer"
        found = "" if fault["type"] == "missing" else f" (found {_short(fault['input'])})"
        reasons.append(f"{field}: {fault['msg']}{found}")
    kind = faults[0]["type"]
    if kind == "missing":
        code = "missing-field"
    elif kind.startswith(("greater_than", "less_than", "too_", "string_too", "literal_error", "enum", "finite")):
        code = "out-of-range"
    elif kind.endswith(("_type", "_parsing", "_from_float")):
        code = "wrong-type"
    else:
        code = "invalid"
    return code, "The answer does not fit the format: " + "; ".join(reasons) + "."


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
