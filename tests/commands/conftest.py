"""Lets the tests of commands use what the tests of the contact half stage trials with, and the stub of a model."""

import contextlib
import io
import json
import sys
from pathlib import Path

import pytest
import yaml

from coral.campaign.episode import perform
from coral.cli import main
from coral.contact.tasks import load_task

sys.path.insert(0, str(Path(__file__).parents[1] / "contact"))
sys.path.insert(0, str(Path(__file__).parents[1] / "advisor"))

from stub import Stub, completion


@pytest.fixture(scope="session")
def task(tmp_path_factory):
    """pick-box with a time limit of 0.2 s, as a file."""
    path = tmp_path_factory.mktemp("task") / "short.yaml"
    content = load_task("pick-box").model_copy(update={"time_limit_s": 0.2}).model_dump(mode="json")
    content["success"]["hold_s"] = 0.1
    path.write_text(yaml.safe_dump(content))
    return str(path)


@pytest.fixture
def refusing(monkeypatch):
    """The address of a model that refuses everything."""
    monkeypatch.delenv("CORAL_LOCAL_API_KEY", raising=False)
    server = Stub(completion("I am sorry, I cannot help with that."))
    yield f"local:{server.url}#m"
    server.close()


class _Here:
    """Runs the episodes of a campaign in this process, which has loaded what they need."""

    jobs = 1

    def run(self, episode, tasks):
        for task in tasks:
            task.scratch.parent.mkdir(parents=True, exist_ok=True)
            yield perform(episode, task.spec, task.scratch)


@pytest.fixture
def in_process(monkeypatch):
    """Campaigns start no processes."""
    monkeypatch.setattr("coral.commands.campaigns.LocalExecutor", lambda jobs: _Here())


@pytest.fixture
def told(capsys):
    """Runs a command in this process; returns its exit code, its object or text, and what it said beside."""

    def run(*words):
        code = main([str(word) for word in words])
        out, err = capsys.readouterr()
        return code, json.loads(out) if "--json" in words and out else out, err

    return run


@pytest.fixture
def refused(told):
    """The one line with which a command refuses what it was given."""

    def run(*words):
        code, out, err = told(*words)
        assert (code, out, err.count("\n")) == (2, "", 1), err
        return err

    return run


@pytest.fixture(scope="session")
def survey(tmp_path_factory):
    """The run folder of a mission of two seconds, without report, and beside it what `--json` printed; read only."""
    folder = tmp_path_factory.mktemp("survey") / "run"
    words = ["--cfg.time-limit-s", "2", "--cfg.record.no-report", "--quiet", "--json", "--out", str(folder)]
    with contextlib.redirect_stdout(io.StringIO()) as said:
        assert main(["reef", "run", "s1", *words]) == 0
    folder.with_name("result.json").write_text(said.getvalue())
    return folder
