"""YAML files of unknown origin, read with limits on their kind, size, nesting and number of values."""

from __future__ import annotations

import os
import stat
from pathlib import Path
from typing import Any

import yaml

from coral.errors import InputError
from coral.plain_yaml import build_plain

MAX_BYTES = 20_000_000


class Loader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]
    """YAML without duplicate keys; with the C parser if available, which is ten times faster with 600 objects."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        """Construct a mapping of the file."""
        seen = set()
        for key, _ in node.value if isinstance(node, yaml.MappingNode) else ():
            if isinstance(key, yaml.ScalarNode) and key.tag != "tag:yaml.org,2002:merge":
                if key.value in seen:
                    raise yaml.MarkedYAMLError(problem=f"the key {key.value!r} twice", problem_mark=key.start_mark)
                seen.add(key.value)
        found: dict[Any, Any] = super().construct_mapping(node, deep=deep)
        return found


def read_regular(path: Path, expected: str, most_bytes: int = MAX_BYTES) -> str:
    """Read the text of a regular file. A pipe could block the reader for ever, a device could deliver endless bytes.

    Args:
        path: Path of the file; links are followed.
        expected: Kind of file, for the message.
        most_bytes: Maximum size.

    Raises:
        InputError: It is missing, a folder, not a regular file, unreadable, too large, or not UTF-8.
    """
    where = str(path)
    try:
        content = regular_bytes(path, most_bytes)
    except FileNotFoundError:
        raise InputError(where, "", "no such file", expected) from None
    except IsADirectoryError:
        raise InputError(where, "", "a folder", expected) from None
    except NotRegularError as error:
        raise InputError(where, "", error.kind, f"a regular file: {expected}") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(where, "", reason.lower(), expected) from None
    if len(content) > most_bytes:
        size = f"{most_bytes / 1e6:.0f} MB"
        raise InputError(where, "", f"more than {size}", f"a file of at most {size}")
    try:
        return content.decode()
    except UnicodeDecodeError:
        raise InputError(where, "", "bytes that are not UTF-8 text", expected) from None


class NotRegularError(OSError):
    """A file without an end, or one that waits for a writer."""

    def __init__(self, kind: str) -> None:
        super().__init__(kind)
        self.kind = kind


def regular_bytes(path: Path, most_bytes: int) -> bytes:
    """Read a regular file, at most one byte more than `most_bytes`.

    Raises:
        NotRegularError: It is a pipe, a device or a socket.
        OSError: It cannot be read.
    """
    # Only this opens a pipe without a writer at once; for a regular file it has no effect.
    descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    with open(descriptor, "rb") as file:
        mode = os.fstat(descriptor).st_mode
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(path)
        if not stat.S_ISREG(mode):
            raise NotRegularError("a named pipe" if stat.S_ISFIFO(mode) else "a device")
        return file.read(most_bytes + 1)


def load_mapping(
    text: str, where: str, most_values: int, expected: str = "a mapping of keys to values"
) -> dict[str, Any]:
    """Return the mapping in a YAML text; {} for an empty one.

    Args:
        text: Text of the file.
        where: The file, for messages.
        most_values: Maximum number of values, including expanded aliases.
        expected: Expected content, for the message.

    Raises:
        InputError: It is not YAML, not a mapping, or nested or expanded without end.
    """
    try:
        plain, content = build_plain(yaml.parse(text, Loader=Loader), where, most_values)
        if not plain:
            content = yaml.load(text, Loader=Loader)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = f"line {mark.line + 1}" if mark else ""
        raise InputError(where, line, getattr(error, "problem", None) or "broken YAML", "valid YAML") from None
    except InputError:
        raise
    except (ValueError, TypeError, RecursionError, OverflowError) as error:  # for example a date such as 2026-13-45
        raise InputError(where, "", str(error) or "brackets nested without end", "valid YAML") from None
    if content is None:
        return {}
    if not isinstance(content, dict):
        raise InputError(where, "", f"a {type(content).__name__}", expected)
    _refuse_alias_expansion(content, where, most_values)
    return content


def _refuse_alias_expansion(content: Any, where: str, most_values: int) -> None:
    """Check the number of values without walking through what a few YAML aliases expand to."""
    seen, stack = 0, [content]
    while stack:
        node = stack.pop()
        children = list(node.values()) if isinstance(node, dict) else node
        seen += len(children)
        if seen > most_values:
            raise InputError(where, "", f"more than {most_values} values", "a smaller file")
        stack.extend(child for child in children if isinstance(child, dict | list))
