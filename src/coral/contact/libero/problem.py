"""A LIBERO problem file (BDDL, a dialect of PDDL): the kinds of its objects and its goal."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from coral.errors import InputError
from coral.foreign_file import read_text


@dataclass(frozen=True)
class Problem:
    """The parts of a problem file that are used."""

    language: str
    """The instruction."""
    objects: dict[str, str]
    """Kind of each object by name, in the order of the simulation's state."""
    target: str
    """The object to move."""
    container: str
    """The object to put it in."""
    region: str
    """The container's region, a box in its model."""


def read_problem(path: Path) -> Problem:
    """Read a file.

    Raises:
        InputError: The file is not a problem file, or its goal is not one object in one region.
    """
    try:
        sections = _parse(read_text(path, "a LIBERO problem file"))
    except IndexError as error:
        raise InputError(str(path), "", type(error).__name__, "a LIBERO problem file") from None
    found = {part[0]: part[1:] for part in sections if isinstance(part, list) and part and isinstance(part[0], str)}
    for key in (":language", ":objects", ":goal"):
        if not found.get(key):
            raise InputError(str(path), key, "nothing", "a LIBERO problem file")
    if not all(isinstance(word, str) for word in found[":language"]):
        raise InputError(str(path), ":language", "parentheses", "words; is one of them closed too late?")
    objects = _objects(found[":objects"], path)
    goals = found[":goal"][0]
    goals = goals[1:] if goals and goals[0] == "And" else [goals]
    if len(goals) != 1 or not _are_words(goals[0], 3) or goals[0][0] != "In" or goals[0][1] not in objects:
        raise InputError(str(path), ":goal", goals, "one (In OBJECT REGION)")
    _, target, place = goals[0]
    container = next((name for name in objects if place.startswith(f"{name}_")), None)
    if container is None or container == target:
        raise InputError(str(path), ":goal", place, f"a region of one of {', '.join(objects)}")
    return Problem(" ".join(found[":language"]), objects, target, container, place[len(container) + 1 :])


def _are_words(part: Any, count: int) -> bool:
    return isinstance(part, list) and len(part) == count and all(isinstance(word, str) for word in part)


def _objects(words: list[Any], path: Path) -> dict[str, str]:
    objects: dict[str, str] = {}
    names: list[str] = []
    following = iter(words)
    for word in following:
        if word == "-":
            kind = next(following, "")
            objects |= dict.fromkeys(names, str(kind))
            names = []
        else:
            names.append(str(word))
    if names or not all(re.fullmatch(r"[a-z0-9_]+", word) for word in (*objects, *objects.values())):
        raise InputError(str(path), ":objects", " ".join(map(str, words)), "NAME ... - KIND")
    return objects


def _parse(text: str) -> list[Any]:
    """Parse the outermost list into nested lists of words."""
    stack: list[list[Any]] = [[]]
    for token in re.findall(r"[()]|[^\s()]+", re.sub(r";.*", "", text)):
        if token == "(":
            stack.append([])
        elif token == ")":
            done = stack.pop()
            stack[-1].append(done)
        else:
            stack[-1].append(token)
    return list(stack[0][0])
