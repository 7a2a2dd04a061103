"""`coral memory bench`, on a few cases."""

import pytest

from coral.commands import memory_bench
from coral.contact.episode.retrieval_cases import load_retrieval_cases


@pytest.fixture
def two_cases(monkeypatch):
    cases = load_retrieval_cases("development")
    chosen = [next(one for one in cases if one.change == change) for change in ("words", "other")]
    monkeypatch.setattr(memory_bench, "load_retrieval_cases", lambda half: chosen)


@pytest.mark.usefixtures("two_cases")
def test_cases_are_counted_by_kind_of_change(told):
    code, result, _ = told("memory", "bench", "--json")
    assert code == 0
    assert {kind: row["cases"] for kind, row in result["by_change"].items()} == {"words": 1, "other": 1, "found": 1}
    assert [one["fits"] for one in result["cases"]] == [["pick-box"], ["none"]]


@pytest.mark.usefixtures("two_cases")
def test_the_table_has_a_row_for_each_kind(told):
    _, text, _ = told("memory", "bench")
    assert [line.split()[0] for line in text.splitlines()[:4]] == ["change", "words", "other", "found"]


def test_a_half_that_is_none_is_refused(refused):
    assert "one of development, test" in refused("memory", "bench", "--half", "both")
