from pathlib import Path

import pytest

from coral.campaign.bench import digest, make_executor, table_json
from coral.campaign.local import LocalExecutor
from coral.campaign.slurm import SlurmCfg
from coral.campaign.table import Table


def test_a_digest_depends_on_contents_and_not_on_their_order():
    assert digest({"a": 1, "b": [1, 2]}) == digest({"b": [1, 2], "a": 1})
    assert digest({"a": 1}) != digest({"a": 2})
    assert digest([1, 2]) != digest([2, 1])


def test_this_machine_runs_as_many_as_asked_for():
    executor = make_executor("local", 3, "nowhere", SlurmCfg(), Path("nowhere"))
    assert isinstance(executor, LocalExecutor)
    assert executor.jobs == 3


def test_a_column_of_the_papers_numbers_is_named_after_its_neighbour():
    table = Table(
        "T", "c", ("variant", "coverage", "paper", "steps", "paper"), (("full", "97", "96", "10", "12"),), ("n",)
    )
    assert table_json(table) == {
        "name": "T",
        "caption": "c",
        "rows": [{"variant": "full", "coverage": "97", "coverage, paper": "96", "steps": "10", "steps, paper": "12"}],
        "notes": ["n"],
    }


def test_a_ragged_row_is_a_mistake():
    table = Table("T", "c", ("a",), (("1",),))
    object.__setattr__(table, "rows", (("1", "2"),))
    with pytest.raises(ValueError, match="zip"):
        table_json(table)
