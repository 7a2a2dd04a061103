"""Validation of an answer against the JSON schema of its question, as pydantic writes it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from jsonschema import Draft202012Validator, ValidationError
from referencing import Registry

MAX_FAULTS = 10
"""Maximum number of reported mismatches."""
LONGEST = 300
"""Characters of a reason."""

Path = tuple[str | int, ...]


@dataclass(frozen=True)
class SchemaFault:
    """A mismatch between a value and its schema."""

    path: Path
    """Keys and positions that lead to the part; () is the whole value."""
    reason: str

    @property
    def place(self) -> str:
        """Format the path, such as "objects.0.mass"."""
        return ".".join(map(str, self.path))


def faults(value: Any, schema: Mapping[str, Any]) -> list[SchemaFault]:
    """Return the mismatches between a value, as `json.loads` returns it, and a JSON schema (draft 2020-12).

    They are at most `MAX_FAULTS`. References to elsewhere are not followed.
    """
    try:
        json.dumps(value, allow_nan=False)
        found = list(Draft202012Validator(schema, registry=Registry()).iter_errors(value))
    except RecursionError:
        return [SchemaFault((), "is nested too deeply, or its schema is")]
    except Exception as error:  # a schema from elsewhere may be broken in every way
        return [SchemaFault((), f"cannot be checked ({type(error).__name__}: {error})"[:LONGEST])]
    return [_fault(error) for error in found[:MAX_FAULTS]]


def _fault(error: ValidationError) -> SchemaFault:
    """Return the fault of a mismatch; of a choice (`anyOf`), that of the option that fits best."""
    while error.context:
        error = max(error.context, key=lambda one: (len(one.absolute_path), one.validator_value != "null"))
    if error.validator == "required":
        name = next(name for name in error.validator_value if error.message.startswith(repr(name)))
        return SchemaFault((*error.absolute_path, name), "is missing")
    return SchemaFault(tuple(error.absolute_path), f"does not fit: {error.message}"[:LONGEST])
