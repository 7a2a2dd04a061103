"""Counts in words, and texts that are numbers."""

from __future__ import annotations


def many(count: int, word: str, plural: str = "") -> str:
    """Format a count: "1 plan", "2 plans"; the plural has an s unless it is given."""
    return f"{count} {word if count == 1 else plural or f'{word}s'}"


def is_numeral(text: str) -> bool:
    """Check whether a text is a number, as Python reads it."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def clock(seconds: float) -> str:
    """Format simulated time as m:ss."""
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02d}"
