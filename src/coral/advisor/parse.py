"""Parsing of an answer from a model's text, without trusting it: thoughts are left out, what broke off is refused."""

from __future__ import annotations

import ast
import json
import re
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
_COMMENT = r"//[^\n]*|/\*.*?\*/|\#[^\n]*"
_LINE_COMMENT = re.compile(r"(?<=[\s,{}\[\]])//")
_TOKEN = re.compile(
    r""""(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*'|[“”„][^“”„]*[“”]|[A-Za-z_]\w*|-?\d[\d.]*(?:[eE][+-]?\d+)?|[\s\[\]{}(),:]+|"""
    + _COMMENT,
    re.DOTALL,
)
_THOUGHT = re.compile(
    r"(?P<open><(?:think|thinking|thought|reasoning|seed:think)>|\[THINK\]|◁think▷|<\|channel\|>analysis)"
    r"|</(?:think|thinking|thought|reasoning|seed:think)>|\[/THINK\]|◁/think▷|<\|channel\|>final(?:<\|message\|>)?",
    re.IGNORECASE,
)
"""Marks of the thoughts of open models: Qwen and DeepSeek, Mistral, Kimi, Seed, gpt-oss."""
_FIRST_KEY = re.compile(r"""\{\s*(?:"[^"\n]*"|'[^'\n]*'|[“”„][^“”„\n]*[“”])\s*:""")
"""The beginning of an object, in contrast to a brace in prose."""
WRAPPERS = (
    *("answer", "final_answer", "response", "result", "output"),
    *("tool_calls", "function", "arguments", "parameters", "properties"),
)
"""Keys under which models put their answer: an envelope, a tool call written as text, the schema filled in."""
_WORDS = {"true": "True", "false": "False", "null": "None", "True": "True", "False": "False", "None": "None"}
_REFUSAL = re.compile(
    r"\b(i['’]?m sorry|i am sorry|i can(?:no|['’])t|i am unable|i['’]m unable|as an ai)\b", re.IGNORECASE
)


def parse_answer(text: str, answer_type: type[A], usage: Usage | None = None) -> A:
    """Find an answer in a reply and validate it.

    Accepted are JSON and Python literals, with comments, curly quotes and trailing commas: alone, in a code fence, or
    surrounded by text, in an envelope or a tool call written as text (`WRAPPERS`). If several passages validate, the
    last one counts: models reason first and answer last. Nothing inside a thought is an answer, and neither is a part
    of an object that is not closed, with one exception: a last brace alone may be missing behind a complete string or
    list, since then nothing but the brace can be lost. (Behind a number, digits may be.)

    Raises:
        BadAnswer: With code "empty", "too-long", "refusal", "cut-off", "not-json", "missing-field", "wrong-type",
            "out-of-range" or "invalid", and a reason that names the change to make.
    """
    said, whole = _without_thoughts(text)
    if not whole:
        reason = "The reply ended inside its thoughts; think less, and end with the answer in the format asked for."
        raise BadAnswer("cut-off", reason, text, usage)
    if not said.strip():
        raise BadAnswer("empty", "The reply was empty; answer in the format asked for.", text, usage)
    if len(said) > MAX_CHARS:
        reason = f"The reply had {len(said)} characters; at most {MAX_CHARS} are read."
        raise BadAnswer("too-long", reason, text[:MAX_CHARS], usage)
    try:
        values = list(_find_values(encodable(said)))
    except _NotClosed:
        reason = "The reply broke off inside its answer, whose last brace is missing; return the whole object."
        raise BadAnswer("cut-off", reason, text, usage) from None
    first_error: ValidationError | None = None
    for value in values:
        try:
            # JSON may escape a lone surrogate, which no file can contain.
            return _validate(encodable_values(value), answer_type)
        except ValidationError as error:
            first_error = first_error or error
        except RecursionError:
            continue
    if first_error is not None:
        raise BadAnswer(*_explain(first_error), text, usage)
    if _REFUSAL.search(said):
        raise BadAnswer("refusal", "The reply declined to answer; choose one of the options as asked.", text, usage)
    reason = "No JSON object could be read in the reply; return only the object asked for."
    raise BadAnswer("not-json", reason, text, usage)


class _NotClosed(ValueError):
    """An object of a reply is not closed."""


def _without_thoughts(text: str) -> tuple[str, bool]:
    """Return what is said outside of thoughts, and whether the last thought was closed.

    Some chat templates open the thought in the prompt: then all before the first closing mark belongs to it.
    """
    if text.lstrip()[:1] == "{" and isinstance(_read(text.strip()), dict):
        return text, True  # a mark inside an answer's own text
    said: list[str] = []
    at, inside = 0, False
    for mark in _THOUGHT.finditer(text):
        if mark["open"] is None:
            said, inside = said if inside else [], False
            at = mark.end()
        elif not inside:
            said.append(text[at : mark.start()])
            inside = True
    return ("".join(said) if inside else "".join([*said, text[at:]])), not inside


def _find_values(text: str) -> list[Any]:
    """Find every object or list in the text, the most likely answer first.

    Raises:
        _NotClosed: An object was begun and not finished.
    """
    whole = _read(text.strip())
    if isinstance(whole, dict | list):
        return [whole]
    spans, opened = _find_bracketed(text)
    last: list[str] = []
    if (start := next((k for k in opened if _FIRST_KEY.match(text, k)), None)) is not None:
        rest = text[start:].rstrip("` \r\n")
        if opened != [start] or rest[-1] not in "\"'”]}" or not isinstance(_read(rest + "}"), dict):
            raise _NotClosed
        last = [rest + "}"]
        spans = [(a, b) for a, b in spans if b <= start]
    passages = [*last, *[match.group(1).strip() for match in _FENCE.finditer(text)][::-1]]
    passages += [text[start:end] for start, end in spans[::-1]]
    return [value for value in map(_read, passages[:MAX_CANDIDATES]) if isinstance(value, dict | list)]


def _find_bracketed(text: str) -> tuple[list[tuple[int, int]], list[int]]:
    """Find the outermost balanced {...} and [...] passages of a text, in order, and the brackets that never close.

    Quotes count only inside brackets, and only double ones: an apostrophe in prose opens no string.
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
        elif opened and _LINE_COMMENT.match(text, i):
            end = text.find("\n", i)
            i = len(text) if end < 0 else end
        elif c in "{[":
            opened.append(i)
        elif c in "}]" and opened:
            start = opened.pop()
            if (text[start] == "{") == (c == "}"):
                while spans and spans[-1][0] > start:
                    spans.pop()
                spans.append((start, i + 1))
        i += 1
    return spans, opened


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
        if token[0] in "/#":
            token = ""
        elif token[0] in "“”„":
            token = '"' + re.sub(r'(?<!\\)"', r"\"", token[1:-1]) + '"'
        if token[:1] in "\"'":
            token = token.replace("\r", "").replace("\n", "\\n")
        elif token[0].isalpha() or token[0] == "_":
            if token not in _WORDS:
                return None
            token = _WORDS[token]
        parts.append(token)
        at = match.end()
    return " ".join(parts)


def _validate(value: Any, answer_type: type[A]) -> A:
    inner = _unwrap(value, answer_type)
    if isinstance(value, list) and inner is not value:
        try:
            return answer_type.model_validate(value)
        except ValidationError:
            pass
    return answer_type.model_validate(inner)


def _unwrap(value: Any, answer_type: type[BaseModel]) -> Any:
    """Return the innermost object of an envelope that has none of the answer's own fields."""
    if isinstance(value, str):
        value = _read(value)
    if isinstance(value, list) and len(value) == 1 and isinstance(value[0], dict):
        return _unwrap(value[0], answer_type)
    if isinstance(value, dict) and not answer_type.model_fields.keys() & value.keys():
        for key in WRAPPERS:
            if key in value and isinstance(inner := _unwrap(value[key], answer_type), dict):
                return inner
    return value


def _explain(error: ValidationError) -> tuple[str, str]:
    """Return code and reason of the first faults of an answer, in words that a model can act on."""
    faults = error.errors(include_url=False, include_context=False)
    reasons = []
    for fault in faults[:3]:
        field = ".".join(str(part) for part in fault["loc"]) or "the answer"
        text = repr(fault["input"])
        shown = text if len(text) <= 60 else text[:57] + "..."
        reasons.append(f"{field}: {fault['msg']}" + ("" if fault["type"] == "missing" else f" (found {shown})"))
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
