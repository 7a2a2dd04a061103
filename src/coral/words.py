"""Counts in words."""

from __future__ import annotations


def many(count: int, word: str, plural: str = "") -> str:
    """Format a count: "1 plan", "2 plans"; the plural has an s unless it is given."""
    return f"{count} {word if count == 1 else plural or f'{word}s'}"
