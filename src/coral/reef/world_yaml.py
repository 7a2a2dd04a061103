"""World files as text: YAML read with a limit on its size, written with one object to a line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from coral.config import Loader
from coral.errors import InputError

MAX_BYTES = 20_000_000
MAX_VALUES = 500_000
"""A file that unfolds (by YAML aliases) to more than this is refused before anything walks through it."""


_LONG = ("spine", "clusters", "obstacles")
"""Keys whose entries get lines of their own, in this order at the end of the file."""
_DUMPER = getattr(yaml, "CSafeDumper", yaml.SafeDumper)


def read_mapping(path: Path) -> dict[str, Any]:
    """Content of a world file, still unchecked.

    Raises:
        InputError: The file is missing, a folder, unreadable, too large, not YAML or not a mapping.
    """
    where = str(path)
    expected = "a readable world file (YAML)"
    try:
        if path.is_dir():
            raise InputError(where, "", "a folder", expected)
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise InputError(where, "", f"{size / 1e6:.0f} MB", f"a world file of at most {MAX_BYTES / 1e6:.0f} MB")
        content = yaml.load(path.read_text(encoding="utf-8"), Loader=Loader)
    except FileNotFoundError:
        raise InputError(where, "", "no such file", expected) from None
    except OSError as error:
        raise InputError(where, "", (error.strerror or "an unreadable file").lower(), expected) from None
    except UnicodeDecodeError:
        raise InputError(where, "", "bytes that are not UTF-8 text", expected) from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = f"line {mark.line + 1}" if mark else ""
        raise InputError(where, line, getattr(error, "problem", None) or "broken YAML", "valid YAML") from None
    except InputError:
        raise
    except (ValueError, TypeError, RecursionError, OverflowError) as error:  # say a date such as 2026-13-45
        raise InputError(where, "", str(error) or "brackets nested without end", expected) from None
    if not isinstance(content, dict):
        found = "an empty file" if content is None else f"a {type(content).__name__}"
        raise InputError(where, "", found, "a mapping with the keys name, size_m, start, clusters, ...")
    _refuse_bombs(content, where)
    return content


def to_text(world: Mapping[str, Any], header: Sequence[str] = ()) -> str:
    """YAML text: comment lines, then one line for every oyster and every obstacle.

    Args:
        world: Plain values as `ReefWorld.model_dump(mode="json")` gives them.
        header: Lines of the comment on top.
    """
    lines = [f"# {line}".rstrip() for line in header]
    lines += [f"{key}: {_flow(value)}" for key, value in world.items() if key not in _LONG]
    for key in _LONG:
        lines.append(f"{key}:" if world[key] else f"{key}: []")
        for item in world[key]:
            if key == "clusters":
                lines += [f"  - name: {_flow(item['name'])}", "    oysters:"]
                lines += [f"      - {_flow(oyster)}" for oyster in item["oysters"]]
            else:
                lines.append(f"  - {_flow(item)}")
    return "\n".join(lines) + "\n"


def _flow(value: Any) -> str:
    """YAML flow style on one line, floats to a thousandth."""
    return (
        yaml.dump(
            _rounded(value),
            Dumper=_DUMPER,
            default_flow_style=True,
            sort_keys=False,
            allow_unicode=True,
            width=1_000_000,
        )
        .removesuffix("...\n")
        .strip()
    )


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, 3) + 0.0  # never -0.0
    if isinstance(value, Mapping):
        return {key: _rounded(item) for key, item in value.items()}
    return [_rounded(item) for item in value] if isinstance(value, list | tuple) else value


def _refuse_bombs(content: dict[str, Any], where: str) -> None:
    seen = 0
    stack: list[Any] = [content]
    while stack:
        node = stack.pop()
        children = list(node.values()) if isinstance(node, dict) else node if isinstance(node, list) else ()
        seen += len(children)
        if seen > MAX_VALUES:
            raise InputError(where, "", f"more than {MAX_VALUES} values", "a world of a few thousand objects")
        stack.extend(child for child in children if isinstance(child, dict | list))
