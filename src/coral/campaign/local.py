"""Episodes in processes of this machine: spawned, one thread each, replaced when they die."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import shutil
import signal
import threading
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from typing import Any, cast

from coral.campaign.episode import ONE_THREAD, Episode, EpisodeOutcome, EpisodeTask, not_run, perform
from coral.errors import RunError

ATTEMPTS = 2
"""A worker may die by accident once (full memory, a signal); an episode that kills two workers is the cause itself."""
_READY = "ready"


@dataclass
class _Worker:
    process: SpawnProcess
    pipe: Connection
    task: EpisodeTask | None = None
    ready: bool = False


class LocalExecutor:
    """Runs episodes in `jobs` spawned processes."""

    def __init__(self, jobs: int) -> None:
        self.jobs = jobs
        self._context = multiprocessing.get_context("spawn")

    def run(self, episode: Episode, tasks: Sequence[EpisodeTask]) -> Iterator[EpisodeOutcome]:
        """Yield each task's outcome as it comes (see `Executor`).

        Raises:
            RunError: Workers do not start.
        """
        queue, deaths = deque(tasks), dict.fromkeys((task.spec.key for task in tasks), 0)
        workers: list[_Worker] = []
        stillborn = 0
        try:
            while queue or any(worker.task for worker in workers):
                while len(workers) < min(self.jobs, len(queue) + sum(worker.task is not None for worker in workers)):
                    workers.append(self._start(episode))
                for worker in workers:
                    _give(worker, queue)
                by_handle: dict[Any, _Worker] = {worker.pipe: worker for worker in workers}
                for handle in wait(list(by_handle)):
                    worker = by_handle[handle]
                    try:
                        message = worker.pipe.recv()
                    except (EOFError, OSError):
                        workers.remove(worker)
                        code = _reap(worker)
                        if not worker.ready:
                            stillborn += 1
                            if stillborn > self.jobs + 1:
                                why = f"end before they begin (exit code {code}); see the messages above"
                                raise RunError(f"the worker processes {why}") from None
                        elif worker.task is not None:
                            key = worker.task.spec.key
                            deaths[key] += 1
                            if deaths[key] < ATTEMPTS:
                                queue.appendleft(worker.task)
                            else:
                                died = f"its worker process died {ATTEMPTS} times ({_cause(code)})"
                                yield not_run(worker.task, died, ATTEMPTS)
                        continue
                    if message == _READY:
                        worker.ready, stillborn = True, 0
                    else:
                        outcome = cast(EpisodeOutcome, message)
                        worker.task = None
                        about = {**outcome.about, "attempts": deaths[outcome.spec.key] + 1}
                        _give(worker, queue)  # before the caller spends time on the outcome
                        yield replace(outcome, about=about)
        finally:
            for worker in workers:
                worker.process.kill()
                _reap(worker)

    def _start(self, episode: Episode) -> _Worker:
        ours, theirs = self._context.Pipe()
        process = self._context.Process(target=_work, args=(theirs, episode), daemon=True)
        with _environment(ONE_THREAD), _block_interrupts():
            process.start()
        theirs.close()
        return _Worker(process, ours)


def _give(worker: _Worker, queue: deque[EpisodeTask]) -> None:
    if queue and worker.ready and worker.task is None:
        worker.task = queue.popleft()
        shutil.rmtree(worker.task.scratch, ignore_errors=True)
        with contextlib.suppress(OSError):  # if it has just died, its closed pipe is noticed and the task requeued
            worker.pipe.send(worker.task)


def _reap(worker: _Worker) -> int:
    worker.process.join()
    worker.pipe.close()
    return worker.process.exitcode or 0


def _cause(code: int) -> str:
    if code >= 0:
        return f"exit code {code}"
    with contextlib.suppress(ValueError):
        return f"signal {signal.Signals(-code).name}"
    return f"signal {-code}"


def _work(pipe: Connection, episode: Episode) -> None:
    """Run a worker: tasks in, outcomes out, until the campaign ends or its process dies."""
    # Ctrl-C reaches every process of the terminal; an episode interrupted by it must not be recorded as finished.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})  # an episode's children must not inherit the block
    threading.Thread(target=_die_with_parent, daemon=True).start()
    pipe.send(_READY)
    while True:
        try:
            task: EpisodeTask = pipe.recv()
        except (EOFError, OSError):
            return
        task.scratch.parent.mkdir(parents=True, exist_ok=True)
        outcome = perform(episode, task.spec, task.scratch)
        pipe.send(outcome)


def _die_with_parent() -> None:
    """Make the worker die with its parent: a killed campaign must not continue to write into its folder."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)


@contextlib.contextmanager
def _block_interrupts() -> Iterator[None]:
    """Block Ctrl-C: it stays pending, and a process started meanwhile never receives it, not even while importing."""
    resource_tracker.ensure_running()  # otherwise it starts with the first worker and undoes the blocking
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def _environment(values: dict[str, str]) -> Iterator[None]:
    """Set variables that a child inherits; BLAS reads them when it is loaded."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
