"""Plain YAML built straight from the parser's events: numbers, texts, lists and mappings, as world files hold them.

PyYAML makes a node of every value, resolves its type and constructs it in Python, after a first pass that limits the
nesting. One pass over the events does both, and repeated scalars are converted once. What is not plain (anchors,
aliases, tags, keys that are no text or given twice, documents in a row) is left to PyYAML.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

import yaml

from coral.errors import InputError

MAX_DEPTH = 50
"""Maximum nesting. PyYAML's C parser is recursive: 15 000 levels end the process by a signal."""

_DECIMAL = re.compile(r"[-+]?(?:0|[1-9][0-9]*)\.[0-9]+", re.ASCII)
_PLAIN_TAGS = {f"tag:yaml.org,2002:{kind}" for kind in ("null", "bool", "int", "float", "str")}
_ODD: Any = object()


class _Scalars(yaml.constructor.SafeConstructor, yaml.resolver.Resolver):
    """Convert the text of plain scalars as PyYAML's safe loader does; each text once."""

    def __init__(self) -> None:
        yaml.constructor.SafeConstructor.__init__(self)
        yaml.resolver.Resolver.__init__(self)
        self._known: dict[str, Any] = {}

    def convert(self, text: str) -> Any:
        """Return the value of a plain scalar, or `_ODD` for a type such as a date."""
        if _DECIMAL.fullmatch(text):
            return float(text)
        if text not in self._known:
            tag = self.resolve(yaml.ScalarNode, text, (True, False))  # type: ignore[no-untyped-call]
            self._known[text] = self.construct_object(yaml.ScalarNode(tag, text)) if tag in _PLAIN_TAGS else _ODD
        return self._known[text]


def build_plain(events: Iterable[Any], where: str, most_values: int) -> tuple[bool, Any]:
    """Build the only document of a stream of events.

    Args:
        events: Events of `yaml.parse`. They are all read, so that their limits hold for what is not plain, too.
        where: The file, for messages.
        most_values: A third of the maximum number of nodes; keys count.

    Returns:
        Whether the document is plain, and if so its content.

    Raises:
        InputError: It is nested too deeply or has too many values.
        yaml.YAMLError: The parser's.
        ValueError: A scalar has no value, for example an integer of 5000 digits.
    """
    scalars, plain, seen = _Scalars(), True, 0
    stack: list[list[Any]] = []
    done: list[Any] = []
    opened = 0
    for event in events:
        if isinstance(event, yaml.NodeEvent):
            seen += 1
            if seen > 3 * most_values:
                raise InputError(where, "", f"more than {most_values} values", "a smaller file")
        if isinstance(event, yaml.CollectionStartEvent):
            opened += 1
            if opened > MAX_DEPTH:
                line = f"line {event.start_mark.line + 1}" if event.start_mark else ""
                raise InputError(where, line, f"values nested more than {MAX_DEPTH} deep", "a file written by hand")
            plain = plain and event.anchor is None and event.tag is None
            if plain:
                stack.append([])
        elif isinstance(event, yaml.CollectionEndEvent):
            opened -= 1
            if plain:
                items = stack.pop()
                value = _mapping(items) if isinstance(event, yaml.MappingEndEvent) else items
                plain = value is not _ODD
                (stack[-1] if stack else done).append(value)
        elif isinstance(event, yaml.ScalarEvent):
            if plain:
                value = _scalar(event, scalars)
                plain = value is not _ODD
                (stack[-1] if stack else done).append(value)
        elif isinstance(event, yaml.AliasEvent):
            plain = False
    if not plain or len(done) > 1:
        return False, None
    return True, done[0] if done else None


def _scalar(event: Any, scalars: _Scalars) -> Any:
    if event.anchor is not None or event.tag is not None:
        return _ODD
    return scalars.convert(event.value) if event.implicit[0] else event.value


def _mapping(items: list[Any]) -> Any:
    """Return the mapping of alternating keys and values; `_ODD` for a key twice, or one that is not text."""
    keys = items[::2]
    if not all(type(key) is str for key in keys):
        return _ODD
    found = dict(zip(keys, items[1::2], strict=True))
    return found if len(found) == len(keys) else _ODD
