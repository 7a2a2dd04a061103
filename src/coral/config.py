"""Configuration: frozen dataclasses, read from YAML with errors that name the field, and written in full."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Annotated, Any, TypeVar, cast, get_origin, get_type_hints

from pydantic import BaseModel, Field, TypeAdapter, ValidationError

from coral.errors import InputError, nearest, shown
from coral.foreign_file import read_text
from coral.validation_errors import input_error
from coral.yaml_file import load_mapping

C = TypeVar("C")
M = TypeVar("M", bound=BaseModel)


Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Fraction = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=1)]
TimeStep = Annotated[float, Field(ge=0.001, le=1, allow_inf_nan=False)]
CellSize = Annotated[float, Field(ge=0.01, le=1, allow_inf_nan=False)]
"""Ranges in seconds and metres: finer values take endless time and memory, coarser ones miss everything."""
Signed = Annotated[float, Field(allow_inf_nan=False)]
"""A number that may be negative; all other numbers in a configuration may not."""


def whole_steps(period_s: float, step_s: float, where: str, field: str) -> int:
    """Return the number of steps in a period.

    Raises:
        InputError: The number is not whole.
    """
    steps = period_s / step_s
    if round(steps) < 1 or abs(steps - round(steps)) > 1e-6:
        raise InputError(where, field, f"{step_s:g} s", f"a whole number of them in {period_s:g} s")
    return round(steps)


def read_config(path: Path, default: C) -> C:
    """Read a configuration from a YAML file with some of the fields; the others come from `default`.

    Raises:
        InputError: The file is missing or broken, or a key or value in it is wrong.
    """
    return merge(default, read_yaml(path), str(path))


def read_yaml(path: Path) -> dict[str, Any]:
    """Read a YAML file that contains a mapping.

    Raises:
        InputError: The file is missing, not regular, unreadable, not YAML, nested too deeply, or not a mapping.
    """
    return load_mapping(read_text(path, "a readable YAML file"), str(path))


def read_model(path: Path, model: type[M]) -> M:
    """Read a YAML file of this model.

    Raises:
        InputError: The file is missing or broken; the error names the field.
    """
    try:
        return model.model_validate(read_yaml(path))
    except ValidationError as error:
        raise input_error(str(path), error, model) from None


def merge(default: C, changes: Mapping[str, Any], where: str) -> C:
    """Replace some fields of `default`, and check the result.

    Raises:
        InputError: A key is unknown (with the nearest known one), or a value has the wrong type or range.
    """
    return checked(cast(C, _replace(default, changes, where, "")), where)


def checked(cfg: C, where: str) -> C:
    """Return the configuration after checking the range of all of its values.

    Fields whose type states no range must be finite and not negative.

    Raises:
        InputError: A value is out of range.
    """
    try:
        _adapter(cast(Any, type(cfg))).validate_python(dataclasses.asdict(cast(Any, cfg)))
    except ValidationError as error:
        first = error.errors()[0]
        field, expected = ".".join(map(str, first["loc"])), first["msg"].replace("Input should be ", "")
        raise InputError(where, field, shown(first["input"]), expected) from None
    _refuse_odd_numbers(cfg, where, "")
    return cfg


def _refuse_odd_numbers(cfg: Any, where: str, prefix: str) -> None:
    hints = get_type_hints(type(cfg), include_extras=True)
    for field in dataclasses.fields(cfg):
        value, name = getattr(cfg, field.name), f"{prefix}{field.name}"
        has_range = get_origin(hints[field.name]) is Annotated
        if dataclasses.is_dataclass(value):
            _refuse_odd_numbers(value, where, f"{name}.")
        elif not has_range and isinstance(value, int | float) and not 0 <= value < math.inf:
            raise InputError(where, name, value, "a finite number of 0 or more")


def to_mapping(cfg: Any) -> dict[str, Any]:
    """Return the plain nested mapping of every field, as written to config.yaml."""
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
            expected = error.errors()[0]["msg"].replace("Input should be ", "")
            raise InputError(where, name, shown(value), expected) from None
    return dataclasses.replace(default, **values)


def changes(now: Mapping[str, Any], default: Mapping[str, Any], prefix: str = "") -> list[tuple[str, Any]]:
    """Return dotted keys, after a prefix, and values in which a configuration differs from the default."""
    found: list[tuple[str, Any]] = []
    for key, value in now.items():
        name = f"{prefix}.{key}" if prefix else key
        if isinstance(value, Mapping) and isinstance(default.get(key), Mapping):
            found += changes(value, default[key], name)
        elif value != default.get(key):
            found.append((name, value))
    return found


def changed_keys(cfg: Any, default: Any) -> list[str]:
    """Return the dotted keys in which two configurations differ."""
    return [key for key, _ in changes(to_mapping(cfg), to_mapping(default))]


def dotted_keys(content: Mapping[str, Any], prefix: str = "") -> list[str]:
    """Return the dotted keys of all values in nested mappings."""
    found: list[str] = []
    for key, value in content.items():
        found += dotted_keys(value, f"{prefix}{key}.") if isinstance(value, Mapping) else [f"{prefix}{key}"]
    return found


def nested(given: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Turn dotted keys into nested mappings.

    Raises:
        InputError: A key is no name, or stands for a value and for a group.
    """
    made: dict[str, Any] = {}
    for key, value in given.items():
        if not isinstance(key, str):
            raise InputError(where, "", repr(key), "names of keys")
        *groups, last = key.replace("-", "_").split(".")
        inner = made
        for group in groups:
            inner = inner.setdefault(group, {})
            if not isinstance(inner, dict):
                raise InputError(where, key, "a value and a group of this name", "one of the two")
        held = nested(value, where) if isinstance(value, Mapping) else value
        if isinstance(held, dict) and isinstance(inner.get(last), dict):
            inner[last] |= held
        else:
            inner[last] = held
    return made


def resolve_settings(given: Any, default: C, where: str = "cfg") -> tuple[C, frozenset[str]]:
    """Return a configuration, and the dotted keys that were set.

    Given is a configuration, a mapping of keys (nested, or dotted as on the command line), a YAML file, or None.

    Raises:
        InputError: A key is unknown, a value is wrong, or the file cannot be read.
    """
    if given is None:
        return default, frozenset()
    if isinstance(given, str | Path):
        content: Mapping[str, Any] = read_yaml(Path(given))
        return merge(default, content, str(given)), frozenset(dotted_keys(content))
    if isinstance(given, Mapping):
        content = nested(given, where)
        return merge(default, content, where), frozenset(dotted_keys(content))
    if not dataclasses.is_dataclass(given) or not isinstance(given, type(default)):
        expected = f"a {type(default).__name__}, a mapping of its keys or a YAML file"
        raise InputError(where, "", f"{type(given).__name__}", expected)
    return given, frozenset(changed_keys(given, default))
