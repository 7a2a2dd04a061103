import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from coral.campaign.campaign import run_campaign
from coral.campaign.local import LocalExecutor
from coral.campaign.store import Store
from coral.errors import RunError


def run(store, specs, episode, jobs=2, mix=True, **options):
    """`mix`, so that files that change while a test runs do not matter to it."""
    with store.lock():
        store.open(specs, {"code": "1"})
        return run_campaign(store, specs, episode, LocalExecutor(jobs), mix=mix, **options)


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path / "out")


def test_good_bad_and_deadly_episodes_each_end_in_one_record(store, specs_of, toy):
    specs = specs_of(worlds=("w", "raises", "exits", "exits-once", "killed", "nan"), seeds=(1,))
    summary = run(store, specs, toy.toy)
    assert (summary.wanted, summary.found, summary.finished, summary.failed) == (6, 0, 2, 4)
    records = store.records()
    assert [record["spec"] for record in records] == [spec.to_json() for spec in specs]
    told = {record["spec"]["world"]: record for record in records}
    assert told["w"]["result"] == {"score": 10, "threads": "1"}
    assert told["w"]["about"]["attempts"] == 1
    assert told["exits-once"]["status"] == "done"
    assert told["exits-once"]["about"]["attempts"] == 2
    assert told["raises"]["message"] == "ValueError: the reef is\nclosed"
    assert "campaign_toy" in told["raises"]["detail"]
    assert told["exits"]["message"] == "its worker process died 2 times (exit code 3)"
    assert told["killed"]["message"] == "its worker process died 2 times (signal SIGKILL)"
    assert "not JSON compliant" in told["nan"]["message"]
    starts = {spec.world: toy.times(specs_of.marks, spec) for spec in specs}
    assert starts == {"w": 1, "raises": 1, "nan": 1, "exits": 2, "killed": 2, "exits-once": 2}
    assert not list(store.folder.glob("runs/.*"))


def test_an_episode_that_workers_cannot_import_is_one_clear_error(store, specs_of, toy, monkeypatch, capfd):
    specs = specs_of()
    monkeypatch.setattr(sys, "path", [p for p in sys.path if not p.endswith("campaign")])
    with pytest.raises(RunError, match="end before they begin"):
        run(store, specs, toy.toy, jobs=1)
    assert "campaign_toy" in capfd.readouterr().err
    assert store.records() == []


def test_the_episode_of_a_dead_worker_goes_to_one_that_is_idle(store, specs_of, toy):
    specs = specs_of(worlds=("last-to-exit", "w"), seeds=(0,))
    assert run(store, specs, toy.toy).finished == 2
    assert [toy.times(specs_of.marks, spec) for spec in specs] == [2, 1]


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_a_killed_campaign_leaves_no_worker_and_goes_on_where_it_was(store, specs_of, toy, how):
    specs, marks = specs_of(), specs_of.marks
    command = [sys.executable, str(Path(toy.__file__)), str(store.folder), str(marks)]
    # A suite that runs in the background of a shell hands down that Ctrl-C is ignored.
    campaign = subprocess.Popen(
        command,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    try:
        eventually(
            lambda: (
                len(list(store.folder.glob("episodes/*.json"))) == 1
                and [toy.times(marks, spec) for spec in specs] == [1, 1, 1]
            )
        )  # written, and not only opened
        if how == signal.SIGINT:
            os.killpg(campaign.pid, how)  # as a terminal does: to the workers, too
            campaign.wait(60)
    finally:
        campaign.kill()
        campaign.wait()
    for spec in specs[1:]:
        pid = int((marks / f"{spec.key}.mark").read_text())
        eventually(lambda pid=pid: not alive(pid))
    assert [record["spec"]["seed"] for record in store.records()] == [0]
    (marks / "go").touch()
    summary = run(store, specs, toy.until_told)
    assert (summary.found, summary.finished) == (1, 2)
    assert [record["result"]["score"] for record in store.records()] == [0, 1, 2]
    assert [toy.times(marks, spec) for spec in specs] == [1, 2, 2]
    assert all((store.run_folder(spec) / "half.txt").exists() for spec in specs)


def test_ctrl_c_while_workers_start_is_the_campaigns_business_alone(store, specs_of, toy, monkeypatch, capfd):
    executor = LocalExecutor(1)
    start = executor._start

    def interrupted(episode):
        worker = start(episode)
        os.kill(worker.process.pid, signal.SIGINT)
        return worker

    monkeypatch.setattr(executor, "_start", interrupted)
    with store.lock():
        store.open(specs_of(), {})
        summary = run_campaign(store, specs_of(), toy.toy, executor, mix=True)
    assert (summary.finished, capfd.readouterr().err) == (3, "")


def eventually(holds, patience_s=60.0):
    """Wait for another process; the limit only ends a test that has failed."""
    limit = time.monotonic() + patience_s
    while not holds():
        assert time.monotonic() < limit
        time.sleep(0.02)


def alive(pid):
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except OSError:
        return False
    return state != "Z"
