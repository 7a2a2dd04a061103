"""Validation errors of pydantic as one line for the author of the file."""

from __future__ import annotations

from collections.abc import Sequence
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError

from coral.errors import InputError, nearest, shown
from coral.words import many


def input_error(where: str, error: ValidationError, model: type[BaseModel]) -> InputError:
    """Convert the first error in a file to one line: dotted field, found, expected; the model knows the valid keys."""
    faults = error.errors(include_url=False)
    fault = faults[0]
    beside = [other for other in faults if other["loc"][:-1] == fault["loc"][:-1]]
    if fault["type"] == "missing":  # an unknown key beside a missing one is that key, misspelt
        fault = next((other for other in beside if other["type"] == "extra_forbidden"), fault)
    kind, place, value = fault["type"], _place_in_file(model, fault["loc"]), fault["input"]
    field = _dotted(place)
    if kind in ("extra_forbidden", "invalid_key"):
        known = _keys(model, fault["loc"][:-1])
        field = _dotted([*place[:-1], str(place[-1])])
        return InputError(where, field, "an unknown key", f"one of {', '.join(known)}{nearest(str(place[-1]), known)}")
    if kind in ("union_tag_not_found", "union_tag_invalid"):
        tags = [tag.strip("'") for tag in fault["ctx"].get("expected_tags", "").split(", ") if tag]
        tag = fault["ctx"]["discriminator"].strip("'")
        if kind == "union_tag_not_found":
            return InputError(where, f"{field}.{tag}", "nothing", "a value")
        found = fault["ctx"]["tag"]
        return InputError(where, f"{field}.{tag}", shown(found), f"one of {', '.join(tags)}{nearest(found, tags)}")
    if kind == "missing" and isinstance(place[-1], int):  # an entry of a list, of which all are told at once
        lacking = sum(other["type"] == "missing" for other in beside)
        return InputError(where, _dotted(place[:-1]), shown(value), many(len(value) + lacking, "entry", "entries"))
    if kind == "missing":
        return InputError(where, field, "nothing", "a value")
    if kind in ("too_short", "too_long"):
        count = fault["ctx"].get("min_length", fault["ctx"].get("max_length"))
        bound = "at least" if kind == "too_short" else "at most"
        return InputError(where, field, many(len(value), "entry", "entries"), f"{bound} {count}")
    if kind == "model_type":
        known = _keys(model, fault["loc"])
        return InputError(where, field, shown(value), f"a mapping with the keys {', '.join(known)}")
    if kind == "value_error":
        return InputError(where, field, shown(value), str(fault["ctx"]["error"]))
    said = fault["msg"].removeprefix("Input should be ").replace("String should have", "text of")
    expected = _EXPECTED.get(kind) or said.replace("String should match pattern", "text like")
    return InputError(where, field, shown(value), expected)


_EXPECTED = {"model_attributes_type": "a mapping", "tuple_type": "a list"}
"""The first is of a value that may be one of several mappings, and is none."""


def _dotted(place: Sequence[int | str]) -> str:
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in place).removeprefix(".")


def _place_in_file(model: type[BaseModel], place: Sequence[int | str]) -> list[int | str]:
    """Return a place as it is in the file: without the tags that pydantic adds for one of several kinds."""
    kept: list[int | str] = []
    kind: Any = model
    for part in place:
        kind = _plain(kind)
        chosen = _members_by_kind(kind).get(part)
        if chosen is not None:
            kind = chosen
            continue
        kept.append(part)
        kind = _inside(kind, part)
    return kept


def _inside(kind: Any, part: int | str) -> Any:
    """Return the type of the value at a key or an index."""
    if isinstance(part, int):
        return (*get_args(kind), None)[0]
    if get_origin(kind) is dict:
        return get_args(kind)[1]
    known = getattr(kind, "model_fields", {})
    return known[part].annotation if part in known else None


def _plain(kind: Any) -> Any:
    """Return the type without annotations, and of a value that may be missing the type that it has otherwise."""
    kind = get_args(kind)[0] if get_origin(kind) is Annotated else kind
    if get_origin(kind) in (Union, UnionType):
        others = [member for member in get_args(kind) if member is not type(None)]
        return _plain(others[0]) if len(others) == 1 else kind
    return kind


def _members_by_kind(kind: Any) -> dict[int | str, Any]:
    """Return the members of a union of models by the value of their `kind`."""
    members = get_args(kind) if get_origin(kind) in (Union, UnionType) else ()
    return {
        member.model_fields["kind"].default: member
        for member in members
        if "kind" in getattr(member, "model_fields", {})
    }


def _keys(model: type[BaseModel], place: Sequence[int | str]) -> list[str]:
    """Return the keys of the mapping at a place in a file, as pydantic names it."""
    kind: Any = model
    for part in place:
        kind = _plain(kind)
        kind = _members_by_kind(kind).get(part) or _inside(kind, part)
    return list(getattr(_plain(kind), "model_fields", ()))
