"""The docstrings below the fields of a dataclass, read from its source."""

from __future__ import annotations

import ast
import inspect
import sys
from functools import cache
from pathlib import Path

from coral.foreign_file import read_text


def field_docs(kind: type) -> dict[str, str]:
    """Return the text of each field of a class and of the classes that it extends, in one line each.

    A field without a docstring has no entry. Source: the file of the class; nothing is executed.
    """
    found: dict[str, str] = {}
    for each in reversed(kind.__mro__):
        found |= _docs_in(each.__module__).get(each.__qualname__, {})
    return found


def class_doc(kind: type) -> str:
    """Return the first paragraph of a class's docstring in one line."""
    return " ".join(inspect.cleandoc(kind.__doc__ or "").partition("\n\n")[0].split())


@cache
def _docs_in(module: str) -> dict[str, dict[str, str]]:
    """Return the texts of the fields by class of a module."""
    path = getattr(sys.modules.get(module), "__file__", None)
    if not path or not path.endswith(".py"):
        return {}
    tree = ast.parse(read_text(Path(path), "a module"))
    return {node.name: _docs_of(node) for node in ast.walk(tree) if isinstance(node, ast.ClassDef)}


def _docs_of(node: ast.ClassDef) -> dict[str, str]:
    found: dict[str, str] = {}
    for field, below in zip(node.body, node.body[1:], strict=False):
        if not (isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name)):
            continue
        if isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant) and isinstance(below.value.value, str):
            found[field.target.id] = " ".join(below.value.value.split())
    return found
