"""Counts in words."""

from __future__ import annotations


def many(count: int, word: str, plural: str = "") -> str:
    """A count in words: "1 plan", "2 plans".

    Args:
        count: How many.
        word: One of them.
        plural: Several of them; `word` with an s by default.
    """
    return f"{count} {word if count == 1 else plural or f'{word}s'}"
