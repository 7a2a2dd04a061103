import json
from dataclasses import dataclass
from pathlib import Path

import pytest
from stub import Stub, completion

from coral.advisor.model_cfg import ModelCfg
from coral.advisor.models import ModelAdvisor
from coral.advisor.rules import RuleAdvisor
from coral.campaign.campaign import Summary
from coral.campaign.spec import NO_ADVISOR, grid
from coral.campaign.store import Store
from coral.campaign.table import Table
from coral.commands.campaigns import CampaignCommand
from coral.commands.reef_bench import ReefBench
from coral.errors import InputError, RunError

TABLE = Table("Table I", "Scores.", ("variant", "score"), (("a", "7"),))
MADE = []
"""What the tables were made from."""


@dataclass(frozen=True, kw_only=True)
class Toys(CampaignCommand):
    name, noun, title = "toy bench", "mission", "Toys"

    out: Path = Path("toys")

    def _advisor(self, name):
        return RuleAdvisor({})

    def _tables(self, rows, about, command):
        MADE[:] = [rows, command]
        return [TABLE]

    def _first_tables(self):
        return [TABLE.name]


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


def test_tables_are_made_of_what_is_recorded_and_told(store):
    command = Toys(out=store.folder)
    result = command._collect(store, Summary(2, 1, 1, 0))
    rows, by = MADE
    assert [(row["seed"], row["status"], row["score"]) for row in rows] == [(0, "done", 7), (1, "failed", None)]
    assert by == "coral toy bench"
    assert (store.folder / "results.parquet").is_file()
    assert [result[key] for key in ("episodes", "done", "failed", "ran", "found")] == [2, 1, 1, 1, 1]
    assert result["results"][0]["rows"] == [{"variant": "a", "score": "7"}]
    for form in ("md", "html"):
        assert "Scores." in (store.folder / f"tables.{form}").read_text(encoding="utf-8")
    told = command.describe({**result, "memory": ""})
    assert "Table I" in told
    assert told.splitlines()[-3:] == [
        f"1 mission; 1 failed (see {store.folder / 'failures'}; --retry-failed runs them again)",
        f"data: {store.folder / 'results.parquet'}",
        f"tables: {store.folder / 'tables.md'}",
    ]


def test_a_campaign_without_a_record_has_no_results(tmp_path):
    store = Store(tmp_path / "out")
    with store.lock():
        store.open(grid("toy", variants=["a"], worlds=["w"], seeds=[0], advisors=["x"]), {})
    with pytest.raises(RunError, match=r"no mission is recorded in .*out yet"):
        Toys(out=store.folder)._collect_recorded()


def begin(store, specs, **flags):
    return Toys(out=store.folder, quiet=True, **flags)._run(specs, lambda spec, folder: {}, {"code": "1"})


def run(store, summary, done, monkeypatch):
    monkeypatch.setattr("coral.commands.campaigns.run_campaign", lambda *_, **__: summary)
    monkeypatch.setattr(Toys, "_collect", lambda *_: {"done": done})
    return begin(store, store.specs(), preflight=False)


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
        begin(store, store.specs())
    assert capsys.readouterr().err == f"stopped; the same command continues from here ({store.folder})\n"


def test_tables_of_recorded_episodes_alone_need_a_campaign(store, tmp_path):
    assert Toys(out=store.folder)._collect_recorded()["ran"] == 0
    with pytest.raises(InputError, match="no campaign"):
        Toys(out=tmp_path / "nothing")._collect_recorded()


def test_the_command_is_told_as_it_was_typed_without_what_changes_nothing():
    words = ("--seeds", "0-4", "--jobs=8", "--sweep", "current=0,1", "--sweep", "driver=pd", "--quiet", "--out", "x")
    words += ("--inbox", "desk", "--cfg.no-stop-when-covered", "--cfg.time-limit-s", "60")
    assert ReefBench(typed=words)._command() == (
        "coral reef bench --seeds 0-4 --sweep current=0,1 --sweep driver=pd --cfg.time-limit-s 60 "
        "--cfg.no-stop-when-covered"
    )


@pytest.mark.parametrize("jobs", [0, -3])
def test_there_is_at_least_one_worker(store, jobs):
    with pytest.raises(InputError, match=f"--jobs: found {jobs}"):
        begin(store, store.specs(), jobs=jobs)


@pytest.fixture
def model():
    """A model's server that answers the small question."""
    server = Stub(completion(json.dumps({"number": 7, "color": "yellow"})))
    yield server
    server.close()


@pytest.fixture
def refusing():
    """A model's server that does not."""
    server = Stub(completion("I am sorry, I cannot help with that."))
    yield server
    server.close()


@pytest.fixture
def asked(tmp_path, model, refusing, monkeypatch):
    """Asks the models of a campaign's episodes; returns the advisors that were made for it."""
    cfg = ModelCfg(attempt_timeout_s=5.0, deadline_s=5.0, backoff_s=0.0, max_retries=0, format_repairs=0)

    made = []

    def make(_, name):
        made.append(name)
        servers = {"good": model, "bad": refusing}
        return ModelAdvisor.local(servers[name].url, name, cfg) if name in servers else RuleAdvisor({})

    def ask(specs, **options):
        made.clear()
        monkeypatch.setattr("coral.commands.campaigns.run_campaign", lambda *_, **__: Summary(0, 0, 0, 0))
        monkeypatch.setattr(Toys, "_collect", lambda *_: {"done": 1})
        monkeypatch.setattr(Toys, "_advisor", make)
        begin(Store(tmp_path / "out"), specs, **options)
        return made

    return ask


def specs(*advisors, alone=()):
    return grid("toy", variants=["a"], worlds=["w"], seeds=[0, 1], advisors=advisors, alone=alone)


def test_each_model_is_asked_once(asked, model):
    assert asked(specs("good", "rules")) == ["good", "rules"]
    assert len(model.requests) == 1


def test_a_model_that_cannot_be_used_refuses_the_campaign_and_nothing_is_written(asked, tmp_path):
    with pytest.raises(InputError, match=r"--advisors.*no answer"):
        asked(specs("good", "bad"))
    assert not (tmp_path / "out").exists()


def test_episodes_that_ask_nobody_need_no_model(asked, model):
    (one, _) = alone = specs("good", alone=["a"])
    assert one.advisor == NO_ADVISOR
    assert asked(alone) == []
    assert model.requests == []


def test_only_models_of_pending_episodes_are_asked(asked, tmp_path):
    wanted = specs("bad")
    store = Store(tmp_path / "out")
    with store.lock():
        store.open(wanted, {"code": "1"})
        store.finish(wanted[0], {}, {})
        store.fail(wanted[1], "no", "", {})
    assert asked(wanted) == []
    with pytest.raises(InputError, match="no answer"):
        asked(wanted, retry_failed=True)
