from pathlib import Path

import pytest

from coral.advisor.fallback import FOR_BENCHES, FOR_RUNS, failed
from coral.contact.thinker.think_cfg import ThinkCfg

DOCS = Path(__file__).parents[2] / "docs"


def test_the_end_reason_names_the_failure():
    assert failed("no-network") == "advisor failed: no-network"


@pytest.mark.parametrize(
    ("page", "row", "default"),
    [("reference/mission-runs.md", "...", FOR_RUNS), ("reference/task-runs.md", "WHY", ThinkCfg().fallback)],
)
def test_the_pages_tell_the_end_reason_and_the_default_of_a_run(page, row, default):
    text = (DOCS / page).read_text(encoding="utf-8")
    assert f"| `{failed(row)}` |" in text
    assert any(line.startswith("| `--fallback") and f"| `{default}` |" in line for line in text.splitlines())


def test_in_a_bench_nobody_else_decides():
    assert FOR_BENCHES != "rules"
    assert f"`{FOR_BENCHES}` (the default" in (DOCS / "guide/compare.md").read_text(encoding="utf-8")
