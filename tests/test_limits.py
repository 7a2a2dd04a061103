"""The page of limits says what the module says."""

import ast
from itertools import pairwise
from pathlib import Path

from coral import limits

ROOT = Path(__file__).parents[1]


def test_every_limit_is_on_the_page_with_its_value_and_reason():
    body = ast.parse((ROOT / "src/coral/limits.py").read_text(encoding="utf-8")).body
    rows = [
        f"| `{one.targets[0].id}` | {getattr(limits, one.targets[0].id):,.0f} | {' '.join(below.value.value.split())} |"
        for one, below in pairwise(body)
        if isinstance(one, ast.Assign)
    ]
    page = (ROOT / "docs/guide/what-we-promise.md").read_text(encoding="utf-8")
    assert len(rows) > 10
    assert [line for line in page.splitlines() if line.startswith("| `")] == rows
