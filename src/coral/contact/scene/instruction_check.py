"""Words of an instruction without a counterpart in its task: colours, amounts and marks that nothing has."""

from __future__ import annotations

import colorsys
import re
from collections.abc import Iterator
from typing import Any

from coral.contact.scene.shapes import Color
from coral.contact.scene.task import Task

HUES = {"red": (345, 15), "orange": (16, 44), "yellow": (45, 69), "green": (70, 169), "blue": (170, 260)}
"""Colours by the range of their hue, degrees."""
GREYS = {"black": (0.0, 0.25), "grey": (0.2, 0.85), "gray": (0.2, 0.85), "white": (0.85, 1.0)}
"""Colours by the range of their brightness."""
PALE = 0.15
"""Below this saturation a colour is a grey."""
UNITS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "n": 1.0, "kg": 1.0, "s": 1.0, "degree": 1.0, "degrees": 1.0, "deg": 1.0}
AMOUNT = re.compile(rf"(\d+(?:\.\d+)?) ?({'|'.join(UNITS)})\b", re.IGNORECASE)
THINGS = re.compile(r"\b(mat|mark|line|edge|goal|spot|place|post|stop|wall|shelf|drawer|door|lid)s?\b")
"""What an instruction may name without its being an object."""


def unmatched_words(task: Task) -> list[str]:
    """Return what an instruction names and neither scene nor conditions have, in words for the author of the task."""
    words = task.instruction.lower()
    shown = _colours(task)
    found = [
        f"{word!r}: nothing in the scene has this colour"
        for word in (*HUES, *GREYS)
        if re.search(rf"\b{word}\b", words) and not any(is_colour(one, word) for one in shown)
    ]
    names = " ".join(_names(task)).replace("_", " ").lower()
    found += [
        f"{thing!r}: no object, fixture, place, point or mark is called so"
        for thing in dict.fromkeys(THINGS.findall(words))
        if thing not in names and f"{thing} of the table" not in words and f"table's left {thing}" not in words
    ]
    numbers = [*_numbers(task.success.model_dump(mode="json")), task.time_limit_s, *task.numbers.values()]
    for amount, unit in AMOUNT.findall(task.instruction):
        value = float(amount) * UNITS[unit.lower()]
        if not any(abs(abs(one) - value) <= 0.02 * value for one in numbers):
            found.append(f"'{amount} {unit}': no condition has this amount")
    return found


def is_colour(color: Color, word: str) -> bool:
    """Check whether a person would call a colour, red, green and blue from 0 to 1, by this word."""
    hue, saturation, value = colorsys.rgb_to_hsv(*color)
    if word in GREYS:
        low, high = GREYS[word]
        return low <= value <= high and (saturation < PALE or value < 0.25)
    low, high = HUES[word]
    turn = 360 * hue
    return saturation >= PALE and (low <= turn <= high if low < high else turn >= low or turn <= high)


def _colours(task: Task) -> list[Color]:
    parts = [part.color or item.color for item in task.objects for part in item.parts]
    return [*parts, *(item.color for item in task.fixtures), *(mark.color for mark in task.marks)]


def _names(task: Task) -> Iterator[str]:
    for item in task.objects:
        yield from (item.name, item.label, *item.points)
    yield from (item.name for item in task.fixtures)
    yield from task.places
    yield from ("mark" for _ in task.marks)


def _numbers(value: Any) -> Iterator[float]:
    if isinstance(value, dict):
        for one in value.values():
            yield from _numbers(one)
    elif isinstance(value, list):
        for one in value:
            yield from _numbers(one)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield float(value)
