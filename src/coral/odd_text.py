"""Sanitised text from models, files and file names, for files, terminals and pictures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

UNKNOWN = "\ufffd"
"""Replacement for a character that cannot be written or shown."""


def encodable(text: str) -> str:
    """Replace lone surrogates, which no encoding accepts, and join separated pairs."""
    if text.isascii():
        return text
    return text.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "replace")


def encodable_values(value: Any) -> Any:
    """Make all text in JSON-like values encodable, keys included; tuples become lists."""
    if isinstance(value, str):
        return encodable(value)
    if isinstance(value, Mapping):
        return {encodable(key) if isinstance(key, str) else key: encodable_values(item) for key, item in value.items()}
    return [encodable_values(item) for item in value] if isinstance(value, list | tuple) else value


def printable(text: str, longest: int | None = None) -> str:
    """Convert text to one line for a terminal or a picture: whitespace becomes spaces, control characters are removed.

    Text of more than `longest` characters is shortened, and ends in "…".
    """
    if longest is not None and len(text) > longest:
        text = text[: longest - 1] + "…"
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else " " if c.isspace() else UNKNOWN for c in encodable(text))
