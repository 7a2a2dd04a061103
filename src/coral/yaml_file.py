"""YAML of unknown origin, read with limits on nesting and on values, with the numbers of YAML 1.2."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, ClassVar

import yaml

from coral.errors import InputError
from coral.limits import YAML_DEPTH, YAML_VALUES

_INT = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+", re.ASCII)
_FLOAT = re.compile(
    r"[-+]?(?:\.[0-9]+|[0-9]+\.[0-9]*)(?:[eE][-+]?[0-9]+)?|[-+]?[0-9]+[eE][-+]?[0-9]+"
    r"|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)",
    re.ASCII,
)
_INT_TAG, _FLOAT_TAG = "tag:yaml.org,2002:int", "tag:yaml.org,2002:float"
_FAULTS = {
    "',' or '}'": "a ',' or '}' is missing",
    "',' or ']'": "a ',' or ']' is missing",
    "mapping values are not allowed": "a ':' too many, or a wrong indent; text with ': ' in it needs quotes",
    "expected key": "lines that belong together are indented differently, or a bracket is too many",
    "'-' indicator": "a line of a list does not begin with '-', or is indented differently",
    "cannot start any token": "a tab, or a value that begins with a special character: indent with spaces, quote text",
    "unexpected end of stream": "a quote that is never closed",
    "expected ':'": "a ':' is missing after a key",
    "another document": "a second document, after '---'",
}
"""What is wrong, by a part of what PyYAML says."""
_OLD_TAGS = {_INT_TAG, _FLOAT_TAG, "tag:yaml.org,2002:timestamp"}
"""YAML 1.1 reads 0120 as 80, 1:30 as 90, 8e-1 as text, and dates as values that no file of ours has."""


def _number_rules(resolvers: Mapping[str, list[Any]]) -> dict[str, list[Any]]:
    """Return PyYAML's rules of plain scalars, by first character, with the numbers of YAML 1.2."""
    found = {first: [rule for rule in rules if rule[0] not in _OLD_TAGS] for first, rules in resolvers.items()}
    for first in "-+.0123456789":
        numbers = [(_INT_TAG, re.compile(f"(?:{_INT.pattern})$")), (_FLOAT_TAG, re.compile(f"(?:{_FLOAT.pattern})$"))]
        found[first] = [*numbers, *found.get(first, [])]
    return found


class Loader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]
    """YAML without duplicate keys; with the C parser if available, which is ten times faster with 600 objects."""

    yaml_implicit_resolvers = _number_rules(yaml.SafeLoader.yaml_implicit_resolvers)

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        """Construct a mapping of the file."""
        seen = set()
        for key, value in node.value if isinstance(node, yaml.MappingNode) else ():
            if isinstance(key, yaml.ScalarNode) and key.tag != "tag:yaml.org,2002:merge":
                if key.value in seen:
                    raise yaml.MarkedYAMLError(problem=f"the key {key.value!r} twice", problem_mark=key.start_mark)
                if node.flow_style and key.tag == _INT_TAG and not value.value:  # {x: 14,00} has a key 00
                    said = f"{key.value!r} after a comma has no value; numbers have a decimal point, as in 14.5"
                    raise yaml.MarkedYAMLError(problem=said, problem_mark=key.start_mark)
                seen.add(key.value)
        found: dict[Any, Any] = super().construct_mapping(node, deep=deep)
        return found

    def construct_yaml_int(self, node: yaml.ScalarNode) -> int:
        """Construct an integer of YAML 1.2."""
        text = self.construct_scalar(node)
        return int(text, {"0o": 8, "0x": 16}.get(text[:2], 10))


Loader.add_constructor(_INT_TAG, Loader.construct_yaml_int)


class _Dumper(getattr(yaml, "CSafeDumper", yaml.SafeDumper)):  # type: ignore[misc]
    """Writes text that looks like a number of YAML 1.1 or 1.2 in quotes."""

    yaml_implicit_resolvers: ClassVar = {
        first: [*rules, *_number_rules(yaml.SafeDumper.yaml_implicit_resolvers).get(first, [])]
        for first, rules in yaml.SafeDumper.yaml_implicit_resolvers.items()
    }


def to_yaml(content: Any, **style: Any) -> str:
    """Write plain values as YAML that `load_mapping` and readers of YAML 1.1 read alike; `style` is `yaml.dump`'s."""
    return str(yaml.dump(content, Dumper=_Dumper, **{"sort_keys": False, "allow_unicode": True, **style}))


def load_mapping(
    text: str,
    where: str,
    most_values: int = YAML_VALUES,
    expected: str = "a mapping of keys to values",
    list_key: str = "",
) -> dict[str, Any]:
    """Return the mapping in a YAML text; {} for an empty one. `where` and `expected` are for messages.

    At most `most_values` are read, expanded aliases included. A list that stands alone is returned under `list_key`;
    "" refuses it.

    Raises:
        InputError: It is not YAML, not a mapping, or nested or expanded without end.
    """
    try:
        _check_events(text, where, most_values)
        content = yaml.load(text, Loader=Loader)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        problem = getattr(error, "problem", None)
        if mark is None or problem is None:
            reason = getattr(error, "reason", "broken YAML").removesuffix(" are not allowed")  # control characters
            raise InputError(where, "", reason, "valid YAML") from None
        said = next((meant for part, meant in _FAULTS.items() if part in problem), problem)
        raise InputError(where, f"line {mark.line + 1}", said, "") from None
    except InputError:
        raise
    except (ValueError, TypeError, RecursionError, OverflowError) as error:  # for example an integer of 5000 digits
        raise InputError(where, "", str(error) or "brackets nested without end", "valid YAML") from None
    if content is None:
        return {}
    if list_key and isinstance(content, list):
        return {list_key: content}
    if not isinstance(content, dict):
        raise InputError(where, "", f"a {type(content).__name__}", expected)
    return content


def _check_events(text: str, where: str, most_values: int) -> None:
    """Count nesting and nodes before anything is built of them; an alias counts as all that it stands for.

    What a merge key (`<<`) copies is copied from an alias, so that it has been counted, too.

    Raises:
        InputError: There is too much of it.
        yaml.YAMLError: It is not YAML.
    """
    seen = 0
    opened: list[tuple[str | None, int]] = []
    sizes: dict[str | None, int] = {}
    for event in yaml.parse(text, Loader=Loader):
        if isinstance(event, yaml.CollectionEndEvent):
            anchor, before = opened.pop()
            if anchor is not None:
                sizes[anchor] = seen - before
            continue
        if not isinstance(event, yaml.NodeEvent):
            continue
        seen += 1
        if isinstance(event, yaml.AliasEvent):
            seen += sizes.get(event.anchor, 0)
            if any(anchor == event.anchor for anchor, _ in opened):
                raise InputError(where, _line(event), f"*{event.anchor} inside itself", "values with an end")
        elif isinstance(event, yaml.CollectionStartEvent):
            opened.append((event.anchor, seen))
            if len(opened) > YAML_DEPTH:
                found = f"values nested more than {YAML_DEPTH} deep"
                raise InputError(where, _line(event), found, "a file with fewer levels")
        if seen > 3 * most_values:
            raise InputError(where, _line(event), f"more than {most_values} values", "a smaller file")


def _line(event: Any) -> str:
    return f"line {event.start_mark.line + 1}" if event.start_mark else ""
