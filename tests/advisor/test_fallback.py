from pathlib import Path

from coral.advisor.fallback import FOR_BENCHES, failed
from coral.contact.episode.trial_log import END_REASONS
from reference import texts

DOCS = Path(__file__).parents[2] / "docs"


def test_the_end_reason_names_the_failure():
    assert failed("no-network") == "advisor failed: no-network"


def test_the_end_reason_is_explained():
    assert failed("no-network").partition(":")[0] in END_REASONS.keys() & texts.SURVEY_ENDS.keys()


def test_in_a_bench_nobody_else_decides():
    assert FOR_BENCHES != "rules"
    assert f"`{FOR_BENCHES}` (the default" in (DOCS / "guide/compare.md").read_text(encoding="utf-8")
