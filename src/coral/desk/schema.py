"""Validation of a JSON value against a JSON schema: the subset that answer models use, with readable reasons."""

from __future__ import annotations

import contextlib
import json
import math
import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

MAX_FAULTS = 10
"""Maximum number of reported mismatches."""
MAX_DEPTH = 32
"""Maximum nesting of an answer."""
MAX_STEPS = 200
"""Maximum number of steps from the schema's root to any part; a schema with more refers to itself."""

Path = tuple[str | int, ...]

_NAMES = {
    "object": "an object",
    "array": "a list",
    "string": "text",
    "integer": "a whole number",
    "number": "a number",
    "boolean": "true or false",
    "null": "null",
}


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
    """Return the mismatches between a value and a schema, at most `MAX_FAULTS`; [] if it fits.

    Supported are types, enum and const, bounds on numbers, lengths, patterns, objects, lists, tuples, `anyOf`, `oneOf`,
    `allOf` and references within the schema; other keywords are checked by the model that reads the answer.

    Args:
        value: A value as returned by `json.loads`.
        schema: A JSON schema (draft 2020-12), as pydantic writes it.
    """
    found: list[SchemaFault] = []
    for fault in _check(value, schema, schema, (), 0):
        found.append(fault)
        if len(found) == MAX_FAULTS:
            break
    return found


def _check(value: Any, schema: Any, root: Mapping[str, Any], path: Path, depth: int) -> Iterator[SchemaFault]:
    if len(path) > MAX_DEPTH or depth > MAX_STEPS:
        yield SchemaFault(path, f"is nested deeper than {MAX_DEPTH} levels")
        return
    if schema is False:
        yield SchemaFault(path, "is not allowed here")
        return
    if not isinstance(schema, Mapping):
        return
    if "$ref" in schema:
        yield from _check(value, _resolve(str(schema["$ref"]), root), root, path, depth + 1)
    types = schema.get("type")
    allowed = [types] if isinstance(types, str) else list(types or ())
    if allowed and not any(_is(value, name) for name in allowed):
        yield SchemaFault(
            path, f"must be {' or '.join(_NAMES.get(name, name) for name in allowed)}, not {_short(value)}"
        )
        return
    if "enum" in schema and not any(_same(value, option) for option in schema["enum"]):
        yield SchemaFault(path, f"must be one of {', '.join(map(_short, schema['enum']))}, not {_short(value)}")
    if "const" in schema and not _same(value, schema["const"]):
        yield SchemaFault(path, f"must be {_short(schema['const'])}, not {_short(value)}")
    for part in schema.get("allOf", ()):
        yield from _check(value, part, root, path, depth + 1)
    for keyword in ("anyOf", "oneOf"):
        if keyword in schema:
            yield from _either(value, schema[keyword], root, path, depth)
    if isinstance(value, int | float) and not isinstance(value, bool):
        yield from _number(value, schema, path)
    elif isinstance(value, str):
        yield from _text(value, schema, path)
    elif isinstance(value, list):
        yield from _list(value, schema, root, path, depth)
    elif isinstance(value, dict):
        yield from _object(value, schema, root, path, depth)


def _either(value: Any, options: list[Any], root: Mapping[str, Any], path: Path, depth: int) -> Iterator[SchemaFault]:
    """Return the faults of the best-fitting option: the one whose first fault lies deepest."""
    tried = []
    for option in options:
        wrong = list(_check(value, option, root, path, depth + 1))
        if not wrong:
            return
        tried.append(wrong)
    best = max(tried, key=lambda wrong: (len(wrong[0].path), "must be null" not in wrong[0].reason), default=[])
    only_null = [option for option in options if isinstance(option, Mapping) and option.get("type") == "null"]
    hint = ", or null" if only_null and best and best[0].path == path else ""
    yield from (SchemaFault(fault.path, fault.reason + hint) for fault in best)


def _number(value: float, schema: Mapping[str, Any], path: Path) -> Iterator[SchemaFault]:
    if isinstance(value, float) and not math.isfinite(value):
        yield SchemaFault(path, "must be finite")
    elif "minimum" in schema and value < schema["minimum"]:
        yield SchemaFault(path, f"must be {schema['minimum']} or more, not {_short(value)}")
    elif "maximum" in schema and value > schema["maximum"]:
        yield SchemaFault(path, f"must be {schema['maximum']} or less, not {_short(value)}")
    elif "exclusiveMinimum" in schema and value <= schema["exclusiveMinimum"]:
        yield SchemaFault(path, f"must be more than {schema['exclusiveMinimum']}, not {_short(value)}")
    elif "exclusiveMaximum" in schema and value >= schema["exclusiveMaximum"]:
        yield SchemaFault(path, f"must be less than {schema['exclusiveMaximum']}, not {_short(value)}")
    elif abs(value) > sys.float_info.max:
        yield SchemaFault(path, "is beyond what a number can be here")
    elif schema.get("multipleOf") and abs(math.remainder(value, schema["multipleOf"])) > 1e-9 * max(1.0, abs(value)):
        yield SchemaFault(path, f"must be a multiple of {schema['multipleOf']}, not {_short(value)}")


def _text(value: str, schema: Mapping[str, Any], path: Path) -> Iterator[SchemaFault]:
    if len(value) < schema.get("minLength", 0):
        yield SchemaFault(path, f"must have {schema['minLength']} characters or more, not {len(value)}")
    if len(value) > schema.get("maxLength", math.inf):
        yield SchemaFault(path, f"must have {schema['maxLength']} characters or fewer, not {len(value)}")
    with contextlib.suppress(re.error):  # patterns are JavaScript's; skip those that Python cannot read
        if "pattern" in schema and not re.search(schema["pattern"], value):
            yield SchemaFault(path, f"must match {schema['pattern']}, which {_short(value)} does not")


def _list(
    value: list[Any], schema: Mapping[str, Any], root: Mapping[str, Any], path: Path, depth: int
) -> Iterator[SchemaFault]:
    if len(value) < schema.get("minItems", 0):
        yield SchemaFault(path, f"must have {schema['minItems']} entries or more, not {len(value)}")
    if len(value) > schema.get("maxItems", math.inf):
        yield SchemaFault(path, f"must have {schema['maxItems']} entries or fewer, not {len(value)}")
    leading = schema.get("prefixItems", ())
    for position, item in enumerate(value):
        of = leading[position] if position < len(leading) else schema.get("items", True)
        yield from _check(item, of, root, (*path, position), depth + 1)


def _object(
    value: dict[str, Any], schema: Mapping[str, Any], root: Mapping[str, Any], path: Path, depth: int
) -> Iterator[SchemaFault]:
    properties = schema.get("properties", {})
    for name in schema.get("required", ()):
        if name not in value:
            yield SchemaFault((*path, name), "is missing")
    for name, item in value.items():
        of = properties[name] if name in properties else schema.get("additionalProperties", True)
        yield from _check(item, of, root, (*path, name), depth + 1)


def _resolve(reference: str, root: Mapping[str, Any]) -> Any:
    """Return the part of the schema at "#/..."; other references are not checked."""
    part: Any = root
    if not reference.startswith("#"):
        return True
    for name in reference[1:].split("/")[1:]:
        name = name.replace("~1", "/").replace("~0", "~")
        if not isinstance(part, Mapping) or name not in part:
            return True
        part = part[name]
    return part


def _is(value: Any, name: str) -> bool:
    if isinstance(value, bool):
        return name == "boolean"
    if name == "integer":
        return isinstance(value, int) or (isinstance(value, float) and value.is_integer())
    kinds: dict[str, Any] = {"object": dict, "array": list, "string": str, "number": int | float, "null": type(None)}
    return name in kinds and isinstance(value, kinds[name])


def _same(a: Any, b: Any) -> bool:
    return bool(a == b) and isinstance(a, bool) == isinstance(b, bool)


def _short(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else text[:57] + "..."
