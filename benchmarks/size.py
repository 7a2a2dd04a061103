"""How large a checkout is: lines, files, classes, settings, flags, helps, and the rooms of reef.

    python benchmarks/size.py [CHECKOUT] > size.json

Imports count with those for type checking. Floors are the longest chain of rooms that import each other, arrows the
pairs of rooms; where reef has no rooms, each of its files is one.
"""

from __future__ import annotations

import ast
import json
import os
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

PROJECT = Path(__file__).parents[1] / "pyproject.toml"
_HELPS = """
import contextlib, io, json
from coral.cli import COMMANDS, main
found = {}
for name in COMMANDS:
    text = io.StringIO()
    with contextlib.redirect_stdout(text), contextlib.suppress(SystemExit):
        main([*name.split(), "--help"])
    found[name] = len(text.getvalue().rstrip().splitlines())
print(json.dumps(found))
"""
_FLAGS = """
import dataclasses, importlib, json, typing
from coral.cli import COMMANDS
def plain(kind):
    return plain(kind.__origin__) if typing.get_origin(kind) is typing.Annotated else kind
def count(kind):
    hints = typing.get_type_hints(kind, include_extras=True)
    kinds = [plain(hints[field.name]) for field in dataclasses.fields(kind)]
    return sum(count(each) if dataclasses.is_dataclass(each) else 1 for each in kinds)
places = [place.partition(":") for place, _ in COMMANDS.values()]
print(json.dumps(sum(count(getattr(importlib.import_module(module), name)) for module, _, name in places)))
"""


def sizes(checkout: Path) -> dict[str, object]:
    """Measure a checkout."""
    package = checkout / "src" / "coral"
    texts = {path.relative_to(package): path.read_text(encoding="utf-8") for path in sorted(package.rglob("*.py"))}
    classes = [node for text in texts.values() for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ClassDef)]
    lines = {path: len(text.splitlines()) for path, text in texts.items()}
    wings = sum(n for path, n in lines.items() if _in_wing(path))
    tests = sum(len(path.read_text(encoding="utf-8").splitlines()) for path in (checkout / "tests").rglob("*.py"))
    helps = _ask(checkout, _HELPS)
    rooms = _rooms(texts)
    return {
        "source lines": sum(lines.values()),
        "of them spine": sum(lines.values()) - wings,
        "of them wings": wings,
        "test lines": tests,
        "files": len(texts),
        "public classes": sum(not node.name.startswith("_") for node in classes),
        "configuration fields": sum(
            isinstance(part, ast.AnnAssign) for node in classes if node.name.endswith("Cfg") for part in node.body
        ),
        "flags": _ask(checkout, _FLAGS),
        "reef rooms": len(rooms),
        "reef arrows": sum(map(len, rooms.values())),
        "reef floors": _floors(rooms),
        "longest help": max(helps.values()),
        "helps": helps,
    }


@cache
def wing_modules() -> tuple[str, ...]:
    """Return the modules of all wings, as the contracts of this checkout list them, without the package's name."""
    contracts = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"]
    listed = [module for one in contracts if one["type"] == "protected" for module in one["protected_modules"]]
    return tuple(module.removeprefix("coral.") for module in listed)


def _in_wing(path: Path) -> bool:
    module = ".".join(path.with_suffix("").parts)
    return any(f"{module}.".startswith(f"{wing}.") for wing in wing_modules())


def _ask(checkout: Path, code: str) -> object:
    """Run a program with the package of the checkout."""
    environment = {**os.environ, "PYTHONPATH": str(checkout / "src"), "COLUMNS": "120"}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def _rooms(texts: dict[Path, str]) -> dict[str, set[str]]:
    """Return which rooms of reef each room imports."""
    rooms: dict[str, set[str]] = {}
    for path, text in texts.items():
        if path.parts[0] != "reef" or path.name == "__init__.py":
            continue
        here = path.with_suffix("").parts[1]
        rooms.setdefault(here, set()).update(other for other in _imported(text) if other != here)
    return {room: {other for other in others if other in rooms} for room, others in rooms.items()}


def _imported(text: str) -> Iterator[str]:
    for node in ast.walk(ast.parse(text)):
        names = [f"{node.module}.{alias.name}" for alias in node.names] if isinstance(node, ast.ImportFrom) else []
        names += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        yield from (name.split(".")[2] for name in names if name.startswith("coral.reef."))


def _floors(rooms: dict[str, set[str]]) -> int:
    """Return the number of rooms in the longest chain; rooms of a circle count once."""
    height: dict[str, int] = {}

    def floor(room: str, above: frozenset[str]) -> int:
        if room not in height:
            below = [floor(other, above | {room}) for other in rooms[room] if other not in above]
            height[room] = 1 + max(below, default=0)
        return height[room]

    return max((floor(room, frozenset()) for room in rooms), default=0)


if __name__ == "__main__":
    print(json.dumps(sizes(Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()), indent=1))
