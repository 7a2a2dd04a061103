"""From the words of a command line to the dataclass of a command; a mistake is one line that names the flag."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal, cast, get_args, get_origin, get_type_hints

from coral.errors import InputError, nearest
from coral.flags import MANY, Described, Flag, taken_apart

Given = dict[tuple[str, ...], list[str]]
"""The words of each flag or argument, by the names of its fields. Yes and no are "yes" and "no"."""


def scan(words: Sequence[str], described: Described, command: str) -> Given:
    """Assign the words after a command's name, such as "reef run", to its flags and arguments; nothing is converted.

    Raises:
        InputError: A flag is unknown, its value is missing, or a word is too many.
    """
    where, help_ = f"coral {command}", f"flags as in: coral {command} --help"
    by_word = {spelling: flag for flag in described.flags for spelling in flag.spellings}
    arguments = [flag for flag in described.flags if flag.positional]
    given: Given = {}
    left = list(words)
    while left:
        word = left.pop(0)
        if not _is_flag(word):
            if not arguments:
                raise InputError(where, "", f"a word too many, {word!r}", help_)
            flag = arguments[0] if arguments[0].words == MANY else arguments.pop(0)
            given.setdefault(flag.field, []).append(word)
            continue
        name, joined, value = word.partition("=")
        name = name.replace("_", "-")
        found = by_word.get(name)
        if found is None:
            raise InputError(where, "", f"an unknown flag {name}", f"{help_}{nearest(name, by_word, 0.7)}")
        if not found.words:
            if joined:
                raise InputError(where, name, repr(value), f"no value: {' or '.join(found.spellings)}")
            given[found.field] = ["yes" if name == found.name else "no"]
            continue
        values = [value] if joined else []
        while left and len(values) != found.words and not joined and not _is_flag(left[0]):
            values.append(left.pop(0))
            if found.optional and values == ["None"]:
                break
        may_be_alone = found.words == MANY and found.metavar.startswith("[")
        if (not values and not may_be_alone) or (len(values) < found.words and values != ["None"]):
            amount = "a value" if found.words in (1, MANY) else f"{found.words} values"
            raise InputError(where, found.name, " ".join(values) or "nothing", f"{amount}: {help_}")
        given[found.field] = [*given.get(found.field, []), *values] if found.repeated else values
    for flag in described.flags:
        if flag.required and flag.field not in given:
            raise InputError(where, flag.name, "nothing", flag.text.rstrip(".") or flag.type)
    return given


def build(kind: type, given: Given, described: Described, command: str, default: Any = None) -> Any:
    """Make a command's dataclass of what `scan` returned; `default` has the values of what is not given.

    Raises:
        InputError: A value is not of the flag's type, or the dataclass refuses it.
    """
    flags = {flag.field: flag for flag in described.flags}
    tree: dict[str, Any] = {}
    for path, words in given.items():
        branch = tree
        for name in path[:-1]:
            branch = branch.setdefault(name, {})
        branch[path[-1]] = _Words(flags[path], words)
    return _made(kind, tree, default, f"coral {command}", "-")


@dataclasses.dataclass(frozen=True)
class _Words:
    flag: Flag
    words: list[str]


def _made(kind: type, tree: Mapping[str, Any], default: Any, where: str, prefix: str) -> Any:
    hints = get_type_hints(kind, include_extras=True)
    fields = {field.name: field for field in dataclasses.fields(kind)}
    values: dict[str, Any] = {}
    for name, value in tree.items():
        base, _, _, optional = taken_apart(hints[name])
        if isinstance(value, _Words):
            values[name] = _converted(value, base, optional, where)
        else:
            factory = cast(Any, fields[name].default_factory)
            old = factory() if default is None else getattr(default, name)
            values[name] = _made(base, value, old, where, f"{prefix}{'-' if prefix == '-' else '.'}{name}")
    try:
        return kind(**values) if default is None else dataclasses.replace(default, **values)
    except InputError as error:  # a configuration does not know under which flag it stands
        flag = f"{prefix}.{error.field}".replace("_", "-")
        raise InputError(where, flag, error.found, error.expected) from None


def _converted(given: _Words, base: Any, optional: bool, where: str) -> Any:
    words, flag = given.words, given.flag
    if base is bool:
        return words == ["yes"]
    if optional and words == ["None"]:
        return None
    if get_origin(base) is not tuple:
        return _value(words[0], base, flag, where)
    items: Iterable[Any] = [taken_apart(item)[0] for item in get_args(base)]
    if Ellipsis in get_args(base):
        items = [taken_apart(get_args(base)[0])[0]] * len(words)
    return tuple(_value(word, item, flag, where) for word, item in zip(words, items, strict=True))


def _value(word: str, base: Any, flag: Flag, where: str) -> Any:
    if get_origin(base) is Literal:
        if word not in get_args(base):
            options = ", ".join(sorted(get_args(base)))
            raise InputError(where, flag.name, repr(word), f"one of {options}{nearest(word, get_args(base))}")
        return word
    try:
        return base(word)
    except ValueError:
        kind = {int: "a whole number", float: "a number"}.get(base, "a value")
        raise InputError(where, flag.name, repr(word), kind) from None


def _is_flag(word: str) -> bool:
    return word.startswith("--") and len(word) > 2
