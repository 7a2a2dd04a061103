"""Words of an instruction without a counterpart in its task: colours, things, amounts and deeds that nothing has."""

from __future__ import annotations

import colorsys
import re
from collections.abc import Iterator
from typing import Any

from coral.contact.scene.shapes import Color
from coral.contact.scene.task import Task

HUES = {
    "red": (345, 15), "brown": (5, 45), "orange": (16, 44), "beige": (20, 60), "golden": (35, 60), "yellow": (45, 69),
    "green": (70, 169), "turquoise": (160, 200), "cyan": (165, 200), "blue": (170, 260), "violet": (250, 320),
    "purple": (255, 325), "magenta": (285, 340), "pink": (300, 10),
}  # fmt: skip
"""Colours by the range of their hue, degrees."""
GREYS = {"black": (0.0, 0.25), "grey": (0.2, 0.85), "gray": (0.2, 0.85), "silver": (0.5, 0.9), "white": (0.85, 1.0)}
"""Colours by the range of their brightness."""
PALE = 0.15
"""Below this saturation a colour is a grey."""
UNITS = {
    "mm": 1e-3, "millimetre": 1e-3, "millimeter": 1e-3, "cm": 1e-2, "centimetre": 1e-2, "centimeter": 1e-2, "m": 1.0,
    "metre": 1.0, "meter": 1.0, "n": 1.0, "newton": 1.0, "kg": 1.0, "kilogram": 1.0, "s": 1.0, "second": 1.0,
    "deg": 1.0, "degree": 1.0,
}  # fmt: skip
NUMBERS = {word: float(k) for k, word in enumerate(
    ("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve")
)} | {"fifteen": 15.0, "twenty": 20.0, "thirty": 30.0, "forty": 40.0, "fifty": 50.0, "sixty": 60.0, "seventy": 70.0,
      "eighty": 80.0, "ninety": 90.0, "hundred": 100.0}  # fmt: skip
_NUMBER = rf"\d+(?:\.\d+)?|(?:{'|'.join(NUMBERS)})(?:-(?:{'|'.join(NUMBERS)}))?"
AMOUNT = re.compile(rf"\b({_NUMBER})[ -]?({'|'.join(UNITS)})s?\b((?:/| per | an? )(?:s|second)\b)?", re.IGNORECASE)
DRAWN = ("mark", "mat", "line", "spot")
"""What an instruction may name and only a picture shows: a place alone is not seen."""
THINGS = re.compile(rf"\b({'|'.join(DRAWN)}|edge|goal|place|post|stop|wall|shelf|drawer|door|lid)s?\b(?! of the table)")
"""What an instruction may name without its being an object."""
DEEDS = {
    r"without lifting|(?:do|must|may) not lift|never lift|along the table": ("kept-touching", "slid"),
    r"without toppling|not (?:\w+ or )?topple": ("kept-level",),
    r"in (?:this |that |the right )?order(?! to)|only then": ("sequence",),
    r"let(?:ting)? go": ("released",),
    r"by (?:its|the) (?:handle|knob)": ("grasped",),
    r"(?:without|never) (?:its )?touch\w*|never touched": ("never-touched",),
    r"without (?:a )?blows?": ("peak-force", "steady-force"),
}
"""What an instruction may ask for, and the kinds of conditions of which one has to judge it."""


def unmatched_words(task: Task) -> list[str]:
    """Return what an instruction names and neither scene nor conditions have, in words for the author of the task."""
    words = task.instruction.lower()
    conditions = [item.model_dump(mode="json") for item in task.success.conditions]
    return [*_unmatched_colours(task, words), *_unmatched_things(task, words), *_unmatched_amounts(task, words),
            *_unmatched_deeds(set(_values(conditions, "kind")), words)]  # fmt: skip


def is_colour(color: Color, word: str) -> bool:
    """Check whether a person would call a colour, red, green and blue from 0 to 1, by this word."""
    hue, saturation, value = colorsys.rgb_to_hsv(*color)
    if word in GREYS:
        low, high = GREYS[word]
        return low <= value <= high and (saturation < PALE or value < 0.25)
    low, high = HUES[word]
    turn = 360 * hue
    return saturation >= PALE and (low <= turn <= high if low < high else turn >= low or turn <= high)


def _unmatched_colours(task: Task, words: str) -> Iterator[str]:
    shown = list(_shown(task))
    for word in (*HUES, *GREYS):
        of = re.search(rf"\b{word} ({'|'.join(DRAWN)})s?\b", words)
        if not re.search(rf"\b{word}\b", words):
            continue
        if not any(is_colour(color, word) for _, color in shown):
            yield f"{word!r}: nothing in the scene has this colour"
        elif of and not any(of[1] in name and is_colour(color, word) for name, color in shown):
            yield f"'{word} {of[1]}': no {of[1]} has this colour"


def _unmatched_things(task: Task, words: str) -> Iterator[str]:
    names = " ".join(_names(task)).replace("_", " ").lower()
    shown = " ".join(name for name, _ in _shown(task))
    for thing in dict.fromkeys(THINGS.findall(words)):
        if thing not in names and f"table's left {thing}" not in words:
            yield f"{thing!r}: no object, fixture, place, point or mark is called so"
        elif thing in DRAWN and thing not in shown:
            yield f"{thing!r}: a place is called so, but nothing is seen there; `marks` draw it"


def _unmatched_amounts(task: Task, words: str) -> Iterator[str]:
    success = task.success.model_dump(mode="json")
    numbers = [*_values(success), task.time_limit_s, *task.numbers.values()]
    speeds = [value for key in ("speed_m_s", "moving_m_s", "turn_rad_s") for value in _values(success, key)]
    for found in AMOUNT.finditer(words):
        parts = [NUMBERS[one] if one in NUMBERS else float(one) for one in found[1].split("-")]
        value = sum(parts) * UNITS[found[2]]
        known = [*speeds, *task.numbers.values()] if found[3] else numbers
        if not any(abs(abs(one) - value) <= 0.02 * value for one in known if isinstance(one, int | float)):
            yield f"{task.instruction[found.start() : found.end()]!r}: no condition has this amount"


def _unmatched_deeds(kinds: set[Any], words: str) -> Iterator[str]:
    for deed, judged_by in DEEDS.items():
        said = re.search(rf"\b(?:{deed})\b", words)
        if said and not kinds & set(judged_by):
            yield f"{said[0]!r}: no condition judges it, such as {' or '.join(judged_by)}"


def _shown(task: Task) -> Iterator[tuple[str, Color]]:
    """Yield what pictures show: names, and a colour for each."""
    for item in task.objects:
        for part in item.parts:
            yield f"{item.name} {item.label} {' '.join(item.points)}".lower(), part.color or item.color
    yield from ((item.name.lower(), item.color) for item in task.fixtures)
    yield from ((f"mark {mark.place.lower()}", mark.color) for mark in task.marks)


def _names(task: Task) -> Iterator[str]:
    for item in task.objects:
        yield from (item.name, item.label, *item.points)
    yield from (item.name for item in task.fixtures)
    yield from task.places
    yield from ("mark" for _ in task.marks)


def _values(value: Any, name: str = "") -> Iterator[Any]:
    """Yield the numbers in nested values, or, with a name, what is called so."""
    if isinstance(value, dict):
        for key, one in value.items():
            if name and key == name:
                yield one
            else:
                yield from _values(one, name)
    elif isinstance(value, list):
        for one in value:
            yield from _values(one, name)
    elif not name and isinstance(value, int | float) and not isinstance(value, bool):
        yield float(value)
