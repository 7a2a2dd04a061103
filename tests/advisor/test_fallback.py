from pathlib import Path

import pytest

from coral.advisor.fallback import FOR_BENCHES, failed

DOCS = Path(__file__).parents[2] / "docs"


def test_the_end_reason_names_the_failure():
    assert failed("no-network") == "advisor failed: no-network"


@pytest.mark.parametrize(("page", "row"), [("reference/mission-runs.md", "..."), ("reference/task-runs.md", "WHY")])
def test_the_pages_tell_the_end_reason(page, row):
    text = (DOCS / page).read_text(encoding="utf-8")
    assert f"| `{failed(row)}` |" in text


def test_in_a_bench_nobody_else_decides():
    assert FOR_BENCHES != "rules"
    assert f"`{FOR_BENCHES}` (the default" in (DOCS / "guide/compare.md").read_text(encoding="utf-8")
