"""Prompts of repairs within bounds: they show less of the history where the scene itself is long."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from coral.advisor.prompt import render

MOST_CHARACTERS = 9_200
"""Characters of a repair's prompt without its author's program: fewer than 3,000 tokens (docs/contact-mind.md)."""
SHORTENED = (("earlier", 1), ("history", 2), ("terms", 1), ("earlier", 0), ("history", 1))
"""What is shortened, in this order, and to how many rows."""


def fit_prompt(kind: str, values: Mapping[str, Any]) -> dict[str, Any]:
    """Leave out rows of the history until the prompt is short enough, or until the fewest rows are left.

    The first and the last row tell what changed, so the middle ones go first.

    Args:
        kind: Kind of question.
        values: Values of its placeholders.
    """
    fitted = {**values, **{key: list(values[key]) for key, _ in SHORTENED}}
    for key, least in SHORTENED:
        rows = fitted[key]
        while len(rows) > least and len(render(kind, {**fitted, "code": "-"})[0]) > MOST_CHARACTERS:
            del rows[(len(rows) - 1) // 2]
    return fitted
