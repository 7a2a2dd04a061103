"""The shape of the package: data goes one way, and a public name means one thing."""

import ast
import importlib
import importlib.util
import re
from collections import defaultdict
from pathlib import Path

from importlinter.cli import EXIT_STATUS_SUCCESS, lint_imports

ROOT = Path(__file__).parents[1]


def test_data_goes_one_way():
    """The contracts stand in pyproject.toml; `lint-imports` prints which of them an import breaks."""
    assert lint_imports(str(ROOT / "pyproject.toml"), cache_dir=None) == EXIT_STATUS_SUCCESS


def test_no_two_public_classes_share_a_name():
    homes = defaultdict(list)
    for path in sorted((ROOT / "src").rglob("*.py")):
        for name in re.findall(r"^ *class ([^\W_]\w*)[(:]", path.read_text(encoding="utf-8"), re.MULTILINE):
            homes[name].append(str(path.relative_to(ROOT)))
    assert len(homes) > 500
    assert {name: found for name, found in homes.items() if len(found) > 1} == {}


def test_every_module_has_its_test_file():
    """`tests/` mirrors `src/coral/`. A module that only declares needs none; a kernel has its twin with its caller."""
    missing = []
    for path in sorted((ROOT / "src/coral").rglob("*.py")):
        module = path.relative_to(ROOT / "src/coral")
        exempt = module.stem in ("__init__", "__main__") or module.stem.endswith("_kernels")
        tests = ROOT / "tests" / module.parent / f"test_{module.stem}.py"
        if not exempt and not tests.is_file() and does_something(path):
            missing.append(str(module))
    assert missing == []


def does_something(path):
    """Whether a module has a function with more in it than a docstring, `...`, `pass` or `raise`."""
    functions = (ast.FunctionDef, ast.AsyncFunctionDef)
    idle = (ast.Pass, ast.Raise)
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, functions):
            body = [
                part for part in node.body if not (isinstance(part, ast.Expr) and isinstance(part.value, ast.Constant))
            ]
            if not all(isinstance(part, idle) for part in body):
                return True
    return False


def outside_imports():
    scripts = [path for folder in ("benchmarks", "docs/figures", "docs/site") for path in (ROOT / folder).glob("*.py")]
    for path in scripts:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("coral"):
                yield from ((path.name, node.module, alias.name) for alias in node.names)


def test_what_scripts_outside_the_package_import_is_there():
    missing = []
    for script, module, name in outside_imports():
        try:
            there = hasattr(importlib.import_module(module), name) or importlib.util.find_spec(f"{module}.{name}")
        except ModuleNotFoundError as error:
            there = not (error.name or "").startswith("coral")  # an extra that is not installed
        if not there:
            missing.append((script, module, name))
    assert not missing
