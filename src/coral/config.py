"""Configuration: frozen dataclasses, read from YAML with errors that name the field, written back complete."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Annotated, Any, TypeVar, cast, get_origin, get_type_hints

from pydantic import Field, TypeAdapter, ValidationError

from coral.errors import InputError, nearest
from coral.validation_errors import shown
from coral.yaml_file import load_mapping, read_regular

C = TypeVar("C")

MAX_VALUES = 200_000

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Fraction = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=1)]
TimeStep = Annotated[float, Field(ge=0.001, le=1, allow_inf_nan=False)]
CellSize = Annotated[float, Field(ge=0.01, le=1, allow_inf_nan=False)]
"""Seconds and metres: finer ones take time and memory without end, coarser ones miss everything."""
Signed = Annotated[float, Field(allow_inf_nan=False)]
"""A number that may be negative: without a type that says so, no number in a configuration may be."""


def whole_steps(period_s: float, step_s: float, where: str, field: str) -> int:
    """Number of steps in a period.

    Args:
        period_s: The period.
        step_s: One step.
        where: File or flag that holds the step, for the error.
        field: Its path in there.

    Raises:
        InputError: It is no whole number.
    """
    steps = period_s / step_s
    if round(steps) < 1 or abs(steps - round(steps)) > 1e-6:
        raise InputError(where, field, f"{step_s:g} s", f"a whole number of them in {period_s:g} s")
    return round(steps)


def read_config(path: Path, default: C) -> C:
    """A configuration from a YAML file that may name only some of the fields; the rest come from `default`.

    Raises:
        InputError: The file is missing or broken, or a key or value in it is wrong.
    """
    return merge(default, read_yaml(path), str(path))


def read_yaml(path: Path) -> dict[str, Any]:
    """A YAML file that holds a mapping.

    Raises:
        InputError: It is missing, no regular file, unreadable, not YAML, nested too deeply, or not a mapping.
    """
    return load_mapping(read_regular(path, "a readable YAML file"), str(path), MAX_VALUES)


def merge(default: C, changes: Mapping[str, Any], where: str) -> C:
    """`default` with some fields replaced, checked.

    Raises:
        InputError: An unknown key (with the nearest known one) or a value of the wrong type or range.
    """
    return checked(cast(C, _replace(default, changes, where, "")), where)


def checked(cfg: C, where: str) -> C:
    """The configuration itself, once all of its values have been found in range.

    Fields whose type states no range hold finite numbers from 0 on.

    Raises:
        InputError: A value is not.
    """
    try:
        _adapter(cast(Any, type(cfg))).validate_python(dataclasses.asdict(cast(Any, cfg)))
    except ValidationError as error:
        first = error.errors()[0]
        raise InputError(
            where,
            ".".join(str(part) for part in first["loc"]),
            shown(first["input"]),
            first["msg"].replace("Input should be ", ""),
        ) from None
    _refuse_odd_numbers(cfg, where, "")
    return cfg


def _refuse_odd_numbers(cfg: Any, where: str, prefix: str) -> None:
    hints = get_type_hints(type(cfg), include_extras=True)
    for field in dataclasses.fields(cfg):
        value, name = getattr(cfg, field.name), f"{prefix}{field.name}"
        if dataclasses.is_dataclass(value):
            _refuse_odd_numbers(value, where, f"{name}.")
        elif (
            get_origin(hints[field.name]) is not Annotated
            and isinstance(value, int | float)
            and not 0 <= value < math.inf
        ):
            raise InputError(where, name, value, "a finite number from 0 on")


def to_mapping(cfg: Any) -> dict[str, Any]:
    """Plain nested mapping of every field, as written to config.yaml."""
    plain: dict[str, Any] = _adapter(cast(Any, type(cfg))).dump_python(cfg, mode="json")
    return plain


@cache
def _adapter(kind: Any) -> TypeAdapter[Any]:
    return TypeAdapter(kind)


def _replace(default: Any, changes: Mapping[str, Any], where: str, prefix: str) -> Any:
    hints = get_type_hints(type(default), include_extras=True)
    values: dict[str, Any] = {}
    for key, value in changes.items():
        name = f"{prefix}{key}"
        if key not in hints:
            raise InputError(where, name, "an unknown key", f"one of {', '.join(hints)}{nearest(str(key), hints)}")
        old = getattr(default, key)
        if dataclasses.is_dataclass(old):
            if not isinstance(value, Mapping):
                raise InputError(where, name, shown(value), "a mapping")
            values[key] = _replace(old, value, where, f"{name}.")
            continue
        try:
            values[key] = TypeAdapter(hints[key]).validate_python(value)
        except ValidationError as error:
            raise InputError(
                where, name, shown(value), error.errors()[0]["msg"].replace("Input should be ", "")
            ) from None
    return dataclasses.replace(default, **values)
