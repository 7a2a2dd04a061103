"""Where the package departs from the papers: sentences of the code, at settings and at what has no setting.

`Departs from the paper:` begins such a sentence, in the text of a key or of a group of keys, or in the docstring of the
module, class, function or constant that departs. There is no other list.
"""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from coral.foreign_file import read_text
from coral.surface import described

DEPARTS = "Departs from the paper:"
PACKAGE = Path(__file__).parents[1]
PARTS = {"reef": "reef", "contact": "contact"}
"""Folder of the package whose code is read, by configuration; the others have none."""


def departs(text: str) -> bool:
    """Return whether a text says how something departs from the paper."""
    return DEPARTS in " ".join(text.split())


def departing_groups(place: str, asked: str) -> dict[str, str]:
    """Return the groups of keys of a configuration whose text departs, below a key or group, or all for ""."""
    about = described(place)
    keys = {group.prefix.removeprefix("--").replace("-", "_"): group.text for group in about.groups}
    return {key: text for key, text in keys.items() if departs(text) and f"{key}.".startswith(asked and f"{asked}.")}


def departing_code(of: str) -> dict[str, list[str]]:
    """Return the paragraphs in docstrings of the code that depart, by file; those of keys and groups are left out."""
    folder = PACKAGE / PARTS[of] if of in PARTS else None
    found: dict[str, list[str]] = {}
    for file in sorted(folder.rglob("*.py")) if folder else ():
        text = read_text(file, "a module of this package")
        if departs(text):
            said = [one for doc in _docstrings(ast.parse(text)) for one in _paragraphs(doc)]
            found |= {f"{file.relative_to(PACKAGE.parent)}": said} if said else {}
    return found


def _docstrings(tree: ast.Module) -> Iterator[str]:
    """Yield the docstrings of module, classes and functions, and the texts below the module's constants."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            yield ast.get_docstring(node) or ""
    for before, node in zip(tree.body, tree.body[1:], strict=False):
        if isinstance(before, ast.Assign | ast.AnnAssign) and isinstance(node, ast.Expr):
            value = node.value
            if isinstance(value, ast.Constant) and isinstance(value.value, str):
                yield inspect.cleandoc(value.value)


def _paragraphs(doc: str) -> Iterator[str]:
    """Yield of each paragraph what departs, from those words on."""
    for paragraph in re.split(r"\n\s*\n", doc):
        _, words, said = " ".join(paragraph.split()).partition(DEPARTS)
        if words:
            yield f"{words}{said}"


def rows_without_key(of: str, place: str, asked: str) -> list[dict[str, Any]]:
    """Return rows, like those of keys, of groups and of code that departs; of code only if no key is asked for."""
    said = list(departing_groups(place, asked).items())
    said += [] if asked else [(file, one) for file, texts in departing_code(of).items() for one in texts]
    empty = dict.fromkeys(("default", "value", "unit", "accepted", "flag"), "")
    return [{"key": key, **empty, "text": text, "refused_by": []} for key, text in said]
