"""Episodes on a Ray cluster without a shared disk, whose nodes may join, leave and fail."""

from __future__ import annotations

import dataclasses
import io
import os
import shutil
import socket
import tarfile
import tempfile
from collections import deque
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from coral.campaign.episode import ONE_THREAD, Episode, EpisodeOutcome, EpisodeTask, not_run, perform
from coral.campaign.spec import Spec
from coral.errors import InputError, RunError, first_line, install_extra

ATTEMPTS = 4
"""A lost node and an episode that kills its worker look alike to the driver, and losing a node is common on a
cluster; hence more attempts than with local processes."""
IN_FLIGHT = 4
"""Tasks submitted to Ray per core of the cluster; pending ones make an autoscaler add nodes."""


class RayExecutor:
    """Runs each episode as a Ray task of one core; the driver alone writes results.

    Args:
        address: `auto`, `HOST:PORT` of the head, or `ray://HOST:PORT` of a Ray client server.

    Raises:
        InputError: Ray is not installed, or the address is invalid.
        RunError: No cluster answers at the address.
    """

    def __init__(self, address: str) -> None:
        os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")  # no usage reports
        os.environ.setdefault("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")
        try:
            import ray
        except ImportError:
            expected = f"local, or {install_extra('ray')}"
            raise InputError("--executor", "", "ray, which is not installed", expected) from None
        self._ray = ray
        _check_listening(address)
        try:
            if not ray.is_initialized():
                ray.init(address=address, log_to_driver=False, logging_level="ERROR")
        except Exception as error:
            raise RunError(f"no Ray cluster at {address}: {first_line(error)}") from None
        self.jobs = max(1, int(ray.cluster_resources().get("CPU", 1)))

    def run(self, episode: Episode, tasks: Sequence[EpisodeTask]) -> Iterator[EpisodeOutcome]:
        """Yield each task's outcome as it comes (see `Executor`)."""
        ray = self._ray
        # Attempts are counted here, not by Ray, so that the record contains their number.
        remote = ray.remote(num_cpus=1, max_retries=0, runtime_env={"env_vars": ONE_THREAD})(_perform_in_task)
        shared = ray.put(episode)
        queue = deque((task, 1) for task in tasks)
        running: dict[Any, tuple[EpisodeTask, int]] = {}
        try:
            while queue or running:
                while queue and len(running) < IN_FLIGHT * self.jobs:
                    task, attempt = queue.popleft()
                    running[remote.remote(shared, task.spec)] = (task, attempt)
                for reference in ray.wait(list(running), num_returns=1)[0]:
                    task, attempt = running.pop(reference)
                    try:
                        outcome, files = ray.get(reference)
                    except ray.exceptions.RayTaskError as error:  # raised by Ray's task, not by the episode
                        yield not_run(task, f"not run by Ray: {first_line(error.cause)}", attempt, error)
                    except ray.exceptions.RayError as error:
                        if attempt < ATTEMPTS:
                            queue.append((task, attempt + 1))
                        else:
                            yield not_run(task, f"lost {ATTEMPTS} times: {type(error).__name__}", attempt, error)
                    else:
                        unpack(files, task.scratch)
                        yield dataclasses.replace(outcome, about={**outcome.about, "attempts": attempt})
        finally:
            for reference in running:
                ray.cancel(reference, force=True)


def _check_listening(address: str) -> None:
    """Check quickly whether anything accepts a connection; Ray itself keeps trying for minutes."""
    host, separator, port = address.removeprefix("ray://").rpartition(":")
    if not separator and address == "auto":
        return
    if not host or not port.isdecimal():
        raise InputError("--address", "", repr(address), "auto, HOST:PORT, or ray://HOST:PORT")
    try:
        socket.create_connection((host.strip("[]"), int(port)), timeout=10.0).close()
    except (OSError, OverflowError) as error:
        raise RunError(f"no Ray cluster at {address}: {getattr(error, 'strerror', None) or error}") from None


def _perform_in_task(episode: Episode, spec: Spec) -> tuple[EpisodeOutcome, bytes]:
    import ray

    return perform_on_node(episode, spec, ray.get_runtime_context().get_node_id())


def perform_on_node(episode: Episode, spec: Spec, node: str) -> tuple[EpisodeOutcome, bytes]:
    """Run one episode in a folder of this node; return the files written there along with the outcome."""
    with tempfile.TemporaryDirectory(prefix="coral-") as folder:
        place = Path(folder) / "run"
        outcome = perform(episode, spec, place)
        return dataclasses.replace(outcome, about={**outcome.about, "node": node}), pack(place)


def pack(folder: Path) -> bytes:
    """Pack the files of a folder into a compressed archive; empty if there is no such folder."""
    if not folder.is_dir():
        return b""
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w:gz", compresslevel=3) as archive:
        archive.add(folder, arcname=".")
    return buffer.getvalue()


def unpack(files: bytes, folder: Path) -> None:
    """Replace a folder with the content of an archive made by `pack`."""
    shutil.rmtree(folder, ignore_errors=True)
    if files:
        folder.mkdir(parents=True)
        with tarfile.open(fileobj=io.BytesIO(files), mode="r:gz") as archive:
            # Python before 3.11.4 has no filters; the archive is one of `pack`, from a node of the same cluster.
            filtered: dict[str, Any] = {"filter": "data"} if hasattr(tarfile, "data_filter") else {}
            archive.extractall(folder, **filtered)
