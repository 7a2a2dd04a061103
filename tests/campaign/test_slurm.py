"""Jobs of Slurm: the loop with jobs in a test's hands, and (marked `slurm`) a real cluster of one node."""

import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from coral.campaign import slurm
from coral.campaign.campaign import run_campaign
from coral.campaign.episode import EpisodeTask
from coral.campaign.slurm import ATTEMPTS, SlurmCfg, SlurmExecutor, queued_jobs
from coral.campaign.store import Store
from coral.errors import InputError, RunError

pytest.importorskip("submitit")


class Job:
    """A job whose result appears when a test says so."""

    def __init__(self, folder, number, call):
        self.job_id, self._call, self._content = str(number), call, None
        self.paths = SimpleNamespace(result_pickle=folder / f"{number}.result", submitted_pickle=folder / "submitted")
        self.cancelled = False

    def run(self, error=None):
        self._content = error if error is not None else self._call()
        self.paths.result_pickle.touch()

    def exception(self):
        return self._content if isinstance(self._content, Exception) else None

    def result(self):
        return self._content

    def cancel(self):
        self.cancelled = True


@pytest.fixture
def executor(tmp_path, monkeypatch):
    """An executor whose jobs end at the first look, unless `fate` says otherwise."""
    folder = tmp_path / "commands"
    folder.mkdir()
    for name in ("srun", "sbatch"):
        (folder / name).write_text("#!/bin/sh\n")
        (folder / name).chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}:{os.environ['PATH']}")
    made = SlurmExecutor(tmp_path / "jobs", 2, SlurmCfg(partition="short"), look_s=0.0)
    made.submitted = []
    made.fate = lambda job, number: job.run()

    def submit(episode, tasks):
        jobs = {}
        for task, attempt in tasks:
            number = len(made.submitted)
            job = Job(tmp_path, number, lambda spec=task.spec: slurm._perform_in_job(episode, spec))
            made.submitted.append(job)
            made.fate(job, number)
            jobs[job] = (task, attempt)
        return jobs

    monkeypatch.setattr(made, "_submit", submit)
    monkeypatch.setattr(made, "_queue", set)
    return made


@pytest.fixture
def tasks(tmp_path, specs_of):
    return [EpisodeTask(spec, tmp_path / "scratch" / spec.key) for spec in specs_of()]


def test_the_requirements_of_a_job_stand_in_its_script(executor):
    script = executor._cluster._make_submission_file_text("true", "x")
    for line in ("--partition=short", "--time=60", "--mem=4096MB", "--cpus-per-task=1", "export OMP_NUM_THREADS=1"):
        assert line in script
    assert "--account" not in script


def test_episodes_come_back_with_their_files(executor, toy, tasks):
    outcomes = list(executor.run(toy.toy, tasks))
    assert [outcome.result["score"] for outcome in outcomes] == [0, 10, 20]
    assert [(task.scratch / "log.txt").read_text() for task in tasks] == ["0\n", "1\n", "2\n"]
    assert {outcome.about["attempts"] for outcome in outcomes} == {1}


def test_a_lost_job_is_submitted_again_and_one_that_waits_is_not(executor, toy, tasks, monkeypatch):
    executor.fate = lambda job, number: job.run() if number not in (0, 1) else None
    looks = []

    def queue():
        looks.append(1)
        if len(looks) == 8:
            executor.submitted[1].run()
        return {"1"}

    monkeypatch.setattr(executor, "_queue", queue)
    outcomes = {outcome.spec.seed: outcome for outcome in executor.run(toy.toy, tasks)}
    assert len(executor.submitted) == 4
    assert {seed: outcome.about["attempts"] for seed, outcome in outcomes.items()} == {0: 2, 1: 1, 2: 1}


def test_a_job_that_is_lost_each_time_is_a_failure_and_a_silent_slurm_loses_none(executor, toy, tasks, monkeypatch):
    executor.fate = lambda job, number: None
    told = iter([None] * 20)
    monkeypatch.setattr(executor, "_queue", lambda: next(told, set()))
    (outcome,) = executor.run(toy.toy, tasks[:1])
    assert outcome.message == f"lost {ATTEMPTS} times"
    assert len(executor.submitted) == ATTEMPTS
    assert list(told) == []


def test_an_error_around_an_episode_is_its_failure(executor, toy, tasks):
    executor.fate = lambda job, number: job.run(RuntimeError("Traceback\n  File ...\nNo module named 'campaign_toy'\n"))
    (outcome,) = executor.run(toy.toy, tasks[:1])
    assert (outcome.result, outcome.message) == (None, "not run by Slurm: No module named 'campaign_toy'")


def test_a_campaign_that_stops_cancels_its_jobs(executor, toy, tasks):
    executor.fate = lambda job, number: job.run() if number == 0 else None
    outcomes = executor.run(toy.toy, tasks)
    next(outcomes)
    outcomes.close()
    assert [job.cancelled for job in executor.submitted] == [False, True, True]


@pytest.mark.parametrize(
    ("cfg", "said"),
    [(SlurmCfg(minutes=0), "--slurm.minutes: found 0"), (SlurmCfg(memory_gb=-1.0), "--slurm.memory-gb: found -1")],
)
def test_a_requirement_out_of_range_is_refused(tmp_path, cfg, said):
    with pytest.raises(InputError, match=said):
        SlurmExecutor(tmp_path, 1, cfg)


def test_without_submitit_or_slurm_the_error_says_so(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError, match="--executor: found slurm, but no srun"):
        SlurmExecutor(tmp_path, 1, SlurmCfg())
    assert queued_jobs() is None
    monkeypatch.setitem(sys.modules, "submitit", None)
    with pytest.raises(InputError, match=r"the extra slurm: "):
        SlurmExecutor(tmp_path, 1, SlurmCfg())


@pytest.fixture
def cluster(monkeypatch):
    """The cluster of this machine; its jobs import the toy episodes."""
    if queued_jobs() is None:
        pytest.fail("no Slurm answers on this machine")
    here = Path(__file__).parent
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(here), str(here.parents[1] / "src")]))


@pytest.mark.slurm
def test_jobs_run_and_a_cancelled_one_runs_again(cluster, tmp_path, specs_of, toy):
    specs = specs_of(worlds=("w", "raises"), seeds=(0, 1))
    store = Store(tmp_path / "out")
    executor = SlurmExecutor(store.folder / ".slurm", 2, SlurmCfg(minutes=2, memory_gb=0.5), look_s=0.5)
    cancel = Canceller()
    with store.lock():
        store.open(specs, {})
        summary = run_campaign(store, specs, cancel.after_submission(executor, toy.toy), executor, mix=True)
    assert (summary.finished, summary.failed) == (2, 2)
    told = {(record["spec"]["world"], record["spec"]["seed"]): record for record in store.records()}
    assert told["w", 1]["result"] == {"score": 10, "threads": "1"}
    assert told["raises", 0]["message"] == "ValueError: the reef is\nclosed"
    assert max(record["about"]["attempts"] for record in store.records()) == 2, "no job was lost"
    assert all((store.run_folder(spec) / "log.txt").exists() for spec in specs if spec.world == "w")
    assert queued_jobs() == set()


@pytest.mark.slurm
def test_jobs_that_slurm_refuses_are_one_line(cluster, tmp_path, toy, tasks):
    with pytest.raises(RunError, match=r"^Slurm refuses the jobs: .*Invalid partition name"):
        list(SlurmExecutor(tmp_path / "jobs", 2, SlurmCfg(partition="nowhere")).run(toy.toy, tasks))


class Canceller:
    """Takes one job from the queue as soon as the jobs are submitted, as a lost node would."""

    def after_submission(self, executor, episode):
        submit = executor._submit

        def submitting(episode, tasks):
            jobs = submit(episode, tasks)
            if len(jobs) > 1:
                subprocess.run(["scancel", list(jobs)[-1].job_id], check=True)
            return jobs

        executor._submit = submitting
        return episode
