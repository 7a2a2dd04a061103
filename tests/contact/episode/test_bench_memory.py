import json

import pyarrow.parquet as pq
import pytest
import yaml
from episodes import ANSWERS, SLIDE
from recorded import as_attempts

from coral.cli import main
from coral.contact.memory.memory import Memory

pytestmark = [pytest.mark.slow, pytest.mark.wing("coral.erring")]
QUICK = [
    "--samples",
    "16",
    "--cfg.controller.horizon",
    "25",
    "--cfg.planning.threads",
    "1",
    "--quiet",
    "--json",
    "--worlds",
    "hand",
    "--poses",
    "ground-truth",
    "--mix",
]


@pytest.fixture(scope="module")
def practised(tmp_path_factory):
    """A task file, and a campaign with a contact strategy and without, of two advisors, one of which errs."""
    folder = tmp_path_factory.mktemp("bench")
    task = folder / "slide.yaml"
    task.write_text(yaml.safe_dump(SLIDE))
    said = folder / "attempts.jsonl"
    said.write_text(as_attempts(ANSWERS))
    assert (
        main(
            [
                "contact",
                "bench",
                "--tasks",
                str(task),
                "--variants",
                "full,unguided",
                "--seeds",
                "5",
                "--advisors",
                f"in-order:{said},sloppy:malformed=0.3:in-order:{said}",
                "--out",
                str(folder / "practice"),
                *QUICK,
            ]
        )
        == 0
    )
    return task, folder / "practice"


def test_a_trial_begins_with_what_practice_left_and_with_nothing_of_its_neighbours(practised, tmp_path, capsys):
    task, practice = practised
    assert (
        main(
            [
                "contact",
                "bench",
                "--tasks",
                str(task),
                "--variants",
                "full",
                "--advisors",
                f"in-order:{practice.parent / 'attempts.jsonl'}",
                "--seeds",
                "0-1",
                "--memory",
                str(practice / "memory.sqlite"),
                "--out",
                str(tmp_path / "out"),
                *QUICK,
            ]
        )
        == 0
    )
    rows = pq.read_table(tmp_path / "out" / "results.parquet").to_pylist()
    kept = len(Memory(practice / "memory.sqlite").all())
    assert [(row["memory_known"], row["memory_hit"], row["advisor_calls"]) for row in rows] == [(kept, True, 1)] * 2
    assert f"at the start of every trial: {kept} (" in (tmp_path / "out" / "tables.md").read_text()
    assert json.loads(capsys.readouterr().out)["memory"] == ""


def test_only_plans_with_regions_are_handed_on(practised):
    _, practice = practised
    kept = Memory(practice / "memory.sqlite").all()
    assert {one.experience.provenance["variant"] for one in kept} == {"full"}
    assert len(list(practice.glob("runs/*_full_*/remembered.sqlite"))) == len(kept)
    assert not list(practice.glob("runs/*_unguided_*/remembered.sqlite"))


def test_an_advisor_that_errs_has_tables_of_its_own(practised):
    _, practice = practised
    page = (practice / "tables.md").read_text()
    spoilt = "Advisor: sloppy:malformed=0.3:in-order:"
    plain = "Advisor: in-order:"
    tables = page.count("**Against CoRAL (full).**")
    assert tables == 2
    assert page.count(spoilt) == page.count(plain) == 6


def test_strategy_and_none_are_compared_in_a_table(practised):
    _, practice = practised
    page = (practice / "tables.md").read_text()
    assert "**Contact-strategy ablation.** slide. World: hand." in page
