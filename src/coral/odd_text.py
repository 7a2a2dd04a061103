"""Text from models, files and file names, made fit for files, terminals and pictures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

UNKNOWN = "\ufffd"
"""Stands for a character that cannot be written or shown."""


def encodable(text: str) -> str:
    """The text with each lone surrogate, which no encoding takes, replaced; parted pairs are joined."""
    if text.isascii():
        return text
    return text.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "replace")


def encodable_values(value: Any) -> Any:
    """JSON-like values with all of their text, keys too, made encodable; tuples become lists."""
    if isinstance(value, str):
        return encodable(value)
    if isinstance(value, Mapping):
        return {encodable(key) if isinstance(key, str) else key: encodable_values(item) for key, item in value.items()}
    return [encodable_values(item) for item in value] if isinstance(value, list | tuple) else value


def printable(text: str, longest: int | None = None) -> str:
    """The text on one line for a terminal or a picture: spaces for what is like one, nothing that steers a terminal.

    Args:
        text: From anywhere.
        longest: Most characters; what is cut ends in "…".
    """
    if longest is not None and len(text) > longest:
        text = text[: longest - 1] + "…"
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else " " if c.isspace() else UNKNOWN for c in encodable(text))
