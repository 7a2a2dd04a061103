import pytest

from coral.campaign.campaign import Summary
from coral.campaign.spec import grid
from coral.campaign.store import Store
from coral.campaign.table import Table
from coral.commands.campaigns import (
    CampaignFlags,
    check_jobs,
    collect_only,
    describe_campaign,
    flag_words,
    read_results,
    run_specs,
    write_tables,
)
from coral.errors import InputError, RunError

TABLE = Table("Table I", "Scores.", ("variant", "score"), (("a", "7"),))


@pytest.fixture
def store(tmp_path):
    """A campaign of which one episode is done and one failed."""
    store = Store(tmp_path / "out")
    specs = grid("toy", variants=["a"], worlds=["w"], seeds=[0, 1], advisors=["x"])
    with store.lock():
        store.open(specs, {"code": "1"})
        store.finish(specs[0], {"score": 7}, {})
        store.fail(specs[1], "no", "", {})
    return store


def test_results_are_rows_and_records_of_done_and_failed(store):
    results = read_results(store, "mission", "coral bench")
    assert [(row["seed"], row["status"], row["score"]) for row in results.rows] == [(0, "done", 7), (1, "failed", None)]
    assert [record["spec"]["seed"] for record in results.done] == [0]
    assert results.command == "coral bench"
    assert (store.folder / "results.parquet").is_file()


def test_a_campaign_without_a_record_has_no_results(tmp_path):
    store = Store(tmp_path / "out")
    with store.lock():
        store.open(grid("toy", variants=["a"], worlds=["w"], seeds=[0], advisors=["x"]), {})
    with pytest.raises(RunError, match=r"no mission is recorded in .*out yet"):
        read_results(store, "mission", "coral bench")


def test_tables_are_written_in_two_forms_and_told(store):
    results = read_results(store, "mission", "coral bench")
    result = write_tables(store, results, [TABLE], "Toys", Summary(2, 1, 1, 0))
    assert [result[key] for key in ("episodes", "done", "failed", "ran", "found")] == [2, 1, 1, 1, 1]
    assert result["results"][0]["rows"] == [{"variant": "a", "score": "7"}]
    for form in ("md", "html"):
        assert "Scores." in (store.folder / f"tables.{form}").read_text(encoding="utf-8")
    more = {**result, "figure": "", "figures": ["one.png", "two.png"]}
    told = describe_campaign(store.folder, more, "mission", ("tables", "figure", "figures"), [TABLE.name])
    assert "Table I" in told
    assert told.splitlines()[-4:] == [
        f"1 mission; 1 failed (see {store.folder / 'failures'}; --retry-failed runs them again)",
        f"tables: {store.folder / 'tables.md'}",
        "figures: one.png",
        "figures: two.png",
    ]


def run(store, summary, done, monkeypatch):
    monkeypatch.setattr("coral.commands.campaigns.run_campaign", lambda *_, **__: summary)
    flags, conditions = CampaignFlags(quiet=True), {"code": "1"}
    return run_specs(
        flags, store, store.specs(), lambda spec, folder: {}, conditions, "", lambda *_: {"done": done}, "mission"
    )


def test_only_a_campaign_in_which_everything_failed_is_a_failure(store, monkeypatch):
    assert run(store, Summary(2, 0, 1, 1), 1, monkeypatch) == {"done": 1}
    run(store, Summary(0, 0, 0, 0), 0, monkeypatch)
    with pytest.raises(RunError, match=r"every mission failed; see .*failures"):
        run(store, Summary(2, 0, 0, 2), 0, monkeypatch)


def test_an_interrupted_campaign_says_that_it_goes_on(store, capsys, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("coral.commands.campaigns.run_campaign", interrupted)
    with pytest.raises(KeyboardInterrupt):
        run_specs(
            CampaignFlags(quiet=True), store, store.specs(), lambda spec, folder: {}, {"code": "1"}, "", dict, "mission"
        )
    assert capsys.readouterr().err == f"stopped; the same command continues from here ({store.folder})\n"


def test_tables_of_recorded_episodes_alone_need_a_campaign(store, tmp_path):
    assert collect_only(store.folder, lambda held, summary: {"of": held.folder, "ran": summary}) == {
        "of": store.folder,
        "ran": None,
    }
    with pytest.raises(InputError, match="no campaign"):
        collect_only(tmp_path / "nothing", lambda *_: {})


def test_flags_without_a_value_are_not_repeated():
    assert flag_words(CampaignFlags(address=""), "jobs", "address") == ["--jobs", "1"]


@pytest.mark.parametrize("jobs", [0, -3])
def test_there_is_at_least_one_worker(jobs):
    check_jobs(1)
    with pytest.raises(InputError, match=f"--jobs: found {jobs}"):
        check_jobs(jobs)
