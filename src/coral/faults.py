"""What pydantic found wrong in a world file, in words for the person who wrote it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from coral.errors import InputError, nearest

LONGEST = 60
"""Letters of a wrong value that are shown."""


def input_error(where: str, error: ValidationError, model: type[BaseModel]) -> InputError:
    """The first fault as one line: dotted field, found, expected.

    Args:
        where: The file.
        error: What validating it raised.
        model: What it was validated as; tells the keys that a place in the file may have.
    """
    fault = error.errors(include_url=False)[0]
    kind, place, value = fault["type"], fault["loc"], fault["input"]
    field = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in place).removeprefix(".")
    if kind in ("extra_forbidden", "invalid_key"):
        known = _keys(model, place[:-1])
        field = ".".join(filter(None, (field.rpartition(".")[0], str(place[-1]))))
        return InputError(where, field, "an unknown key", f"one of {', '.join(known)}{nearest(str(place[-1]), known)}")
    if kind == "missing":
        return InputError(where, field, "nothing", "a value")
    if kind in ("too_short", "too_long"):
        count = fault["ctx"].get("min_length", fault["ctx"].get("max_length"))
        bound = "at least" if kind == "too_short" else "at most"
        return InputError(where, field, f"{len(value)} entries", f"{bound} {count}")
    if kind == "model_type":
        return InputError(where, field, shown(value), f"a mapping with the keys {', '.join(_keys(model, place))}")
    if kind == "tuple_type":
        return InputError(where, field, shown(value), "a list")
    if kind == "value_error":
        return InputError(where, field, shown(value), str(fault["ctx"]["error"]))
    expected = fault["msg"].removeprefix("Input should be ").replace("String should have", "text of")
    return InputError(where, field, shown(value), expected)


def shown(value: Any) -> str:
    """A wrong value as a message shows it."""
    text = repr(value)
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


def _keys(model: type[BaseModel], place: Sequence[int | str]) -> list[str]:
    """Keys of the mapping at some place in a file."""
    kind: Any = model
    for part in place:
        kind = get_args(kind)[0] if isinstance(part, int) else kind.model_fields[part].annotation
    return list(kind.model_fields)
