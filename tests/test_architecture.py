"""The shape of the package: data goes one way, and a public name means one thing."""

import ast
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
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                homes[node.name].append(str(path.relative_to(ROOT)))
    assert {name: found for name, found in homes.items() if len(found) > 1} == {}


def test_every_folder_of_modules_has_its_folder_of_tests():
    """`tests/` mirrors `src/coral/`: a module is tested in the folder of its name, by itself or through its users."""
    folders = {path.parent.relative_to(ROOT / "src/coral") for path in (ROOT / "src/coral").rglob("*.py")}
    assert [str(folder) for folder in sorted(folders) if not (ROOT / "tests" / folder).is_dir()] == []
