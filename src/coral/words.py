"""Counts in words."""

from __future__ import annotations


def many(count: int, word: str, plural: str = "") -> str:
    """Format a count: "1 plan", "2 plans".

    Args:
        count: The count.
        word: The singular.
        plural: The plural; `word` with an s by default.
    """
    return f"{count} {word if count == 1 else plural or f'{word}s'}"
