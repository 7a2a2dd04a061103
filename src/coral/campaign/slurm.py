"""Episodes as jobs of a Slurm cluster, in job arrays that submitit writes."""

from __future__ import annotations

import logging
import os
import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from coral.campaign.cluster import perform_on_node, unpack
from coral.campaign.episode import ONE_THREAD, Episode, EpisodeOutcome, EpisodeTask, not_run
from coral.campaign.spec import Spec
from coral.errors import InputError, RunError, install_extra

ATTEMPTS = 4
"""A lost node and an episode that kills its process look alike from here, as with Ray."""
ARRAY = 500
"""Maximum number of jobs in one array; Slurm's own limit is 1000 unless a site changes it."""
LOOKS = 3
"""A job that neither waits nor runs, and has no result, counts as lost after this many looks at the queue: a shared
disk may show a file late."""


@dataclass(frozen=True, kw_only=True)
class SlurmCfg:
    """Requirements of each job of a campaign on Slurm; one episode is one job of one core."""

    partition: str = ""
    """Partition; "" is the site's default."""
    account: str = ""
    """Account that is charged; "" is the user's default."""
    minutes: int = 60
    """Time limit of an episode (min); Slurm ends it then, and it counts as failed."""
    memory_gb: float = 4.0
    """Memory of an episode (GB)."""


class SlurmExecutor:
    """Submits each episode as a Slurm job, at most `jobs` at once; the driver alone writes results.

    Scripts, results and logs of the jobs go into a folder on a disk that all nodes share. Results are looked for every
    `look_s` (s), and the queue is looked at every third time.

    Raises:
        InputError: submitit or Slurm is not installed here, or a requirement is out of range.
    """

    def __init__(self, folder: Path, jobs: int, cfg: SlurmCfg, look_s: float = 5.0) -> None:
        try:
            import submitit
        except ImportError:
            raise InputError("--executor", "", "no package submitit", f"local, or {install_extra('slurm')}") from None
        for flag, number in (("minutes", cfg.minutes), ("memory-gb", cfg.memory_gb)):
            if not number > 0:
                raise InputError(f"--slurm.{flag}", "", number, "a number above 0")
        logging.getLogger("submitit").setLevel(logging.ERROR)
        try:
            self._cluster = submitit.SlurmExecutor(folder)
        except RuntimeError:
            expected = "a machine from which jobs are submitted"
            raise InputError("--executor", "", "slurm, but no srun", expected) from None
        self._cluster.update_parameters(
            job_name="coral",
            time=cfg.minutes,
            mem=f"{max(1, round(cfg.memory_gb * 1024))}MB",
            cpus_per_task=1,
            array_parallelism=jobs,
            setup=[f"export {name}={value}" for name, value in ONE_THREAD.items()],
            **{name: value for name in ("partition", "account") if (value := getattr(cfg, name))},
        )
        self._failure = submitit.core.utils.FailedJobError
        self.jobs, self._look_s = jobs, look_s
        self._queue: Callable[[], set[str] | None] = queued_jobs

    def run(self, episode: Episode, tasks: Sequence[EpisodeTask]) -> Iterator[EpisodeOutcome]:
        """Yield each task's outcome as it comes (see `Executor`).

        Raises:
            RunError: Slurm refuses the jobs.
        """
        waiting = [(task, 1) for task in tasks]
        running: dict[Any, tuple[EpisodeTask, int]] = {}
        absent: dict[Any, int] = {}
        looks = 0
        try:
            while waiting or running:
                if waiting and len(running) < self.jobs:
                    running.update(self._submit(episode, waiting[:ARRAY]))
                    waiting = waiting[ARRAY:]
                ended = [job for job in running if job.paths.result_pickle.exists()]
                for job in ended:
                    task, attempt = running.pop(job)
                    yield self._outcome(job, task, attempt)
                if not ended and looks % 3 == 2:
                    there = self._queue()
                    for job in [job for job in running if there is not None and job.job_id not in there]:
                        absent[job] = absent.get(job, 0) + 1
                        if absent[job] >= LOOKS and not job.paths.result_pickle.exists():
                            task, attempt = running.pop(job)
                            if attempt < ATTEMPTS:
                                waiting.append((task, attempt + 1))
                            else:
                                yield not_run(task, f"lost {ATTEMPTS} times", attempt)
                if not ended and running:
                    looks += 1
                    time.sleep(self._look_s)
        finally:
            for job in running:
                with suppress(subprocess.CalledProcessError, OSError):
                    job.cancel()

    def _submit(self, episode: Episode, tasks: Sequence[tuple[EpisodeTask, int]]) -> dict[Any, tuple[EpisodeTask, int]]:
        try:
            with self._cluster.batch():  # submitted at its end
                jobs = [self._cluster.submit(_perform_in_job, episode, task.spec) for task, _ in tasks]
            return dict(zip(jobs, tasks, strict=True))
        except (self._failure, OSError) as error:
            raise RunError(f"Slurm refuses the jobs: {_reason(error)}") from None

    def _outcome(self, job: Any, task: EpisodeTask, attempt: int) -> EpisodeOutcome:
        error = job.exception()
        if error is not None:  # raised around the episode, not by it: a time limit, a node that cannot import it
            return not_run(task, f"not run by Slurm: {_reason(error)}", attempt, error)
        outcome: EpisodeOutcome
        outcome, files = job.result()
        unpack(files, task.scratch)
        for path in (job.paths.result_pickle, job.paths.submitted_pickle):
            path.unlink(missing_ok=True)
        about = {**outcome.about, "attempts": attempt, "job": job.job_id}
        return replace(outcome, about=about)


def queued_jobs() -> set[str] | None:
    """Return the ids of this user's jobs that wait or run, `JOB` or `ARRAY_INDEX`; None if Slurm does not tell."""
    command = ["squeue", "--me", "--array", "--noheader", "--format=%i"]
    try:
        told = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return set(told.stdout.split()) if told.returncode == 0 else None


def _reason(error: BaseException) -> str:
    """Return the last line of an error that says something: submitit wraps Slurm's in a traceback."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip(" -\t")]
    return lines[-1] if lines else type(error).__name__


def _perform_in_job(episode: Episode, spec: Spec) -> tuple[EpisodeOutcome, bytes]:
    return perform_on_node(episode, spec, os.environ.get("SLURMD_NODENAME", ""))
