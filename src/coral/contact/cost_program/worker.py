"""Runs a model's cost in a separate process: if it hangs, exhausts memory or breaks out, only that process suffers."""

from __future__ import annotations

import contextlib
import json
import math
import os
import select
import signal
import subprocess
import sys
import tempfile
import threading
import time
import weakref
from dataclasses import dataclass, field
from mmap import mmap
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from coral.contact.cost.context import Context, Schema, Terms
from coral.contact.cost_program.answers import Loaded, Ran, Ready, WorkerAnswer, WorkerFailure
from coral.contact.cost_program.errors import CODES, CostError, is_term_name, printable
from coral.contact.cost_program.limits import MOST_CHARACTERS, MOST_TERMS
from coral.contact.cost_program.sandbox import HEADER, LONGEST_MESSAGE, Request
from coral.contact.cost_program.seccomp import MACHINES
from coral.errors import InputError

START = "from coral.contact.cost_program.sandbox import main; main()"
ALLOW_UNFILTERED = "CORAL_ALLOW_UNFILTERED_COSTS"
A = TypeVar("A", bound=WorkerAnswer)
KEPT_ENVIRONMENT = ("LD_LIBRARY_PATH", "SYSTEMROOT")  # nothing else, so that API keys stay outside


@dataclass(frozen=True, kw_only=True)
class WorkerCfg:
    """Limits of the cost process."""

    cpu_s: float = 1.0
    """Processor time per batch, after which the process is killed; a cost takes about 0.01 s."""
    wait_s: float = 10.0
    """Longest wait for one batch, on a machine with other load."""
    start_s: float = 60.0
    """Longest wait for the process to start."""
    memory_bytes: int = 1 << 30
    """Memory that it may use in addition to its initial memory."""
    shared_bytes: int = 32 << 20
    """Size of the shared arrays; it grows when a batch needs more."""
    allow_unfiltered: bool = field(default_factory=lambda: os.environ.get(ALLOW_UNFILTERED) == "1")
    """Whether to run costs if the machine cannot filter system calls; otherwise that is an error."""


class CostWorker:
    """A persistent process that loads and evaluates cost programs.

    It starts at the first use, and again after a kill. Use it as a context manager, or close it.
    """

    def __init__(self, cfg: WorkerCfg | None = None) -> None:
        self.cfg = cfg or WorkerCfg()
        self.starts = 0
        self.filtered = False
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._shared_bytes = self.cfg.shared_bytes
        self._memory: NDArray[np.float64] = np.zeros(0)
        self._loaded: set[int] = set()
        self._next = 1
        self._finalizer: weakref.finalize[Any, CostWorker] | None = None

    def __enter__(self) -> CostWorker:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def pid(self) -> int | None:
        """Process id, None if it is not running."""
        return self._process.pid if self._process else None

    def load(self, source: str, schema: Schema, name: str = "program") -> WorkerCost:
        """Load and check a program.

        Raises:
            CostError: The text is not a program of the accepted language.
        """
        with self._lock:
            number, self._next = self._next, self._next + 1
            cost = WorkerCost(self, number, source, schema, name)
            loaded = self._load(cost)
            cost.reads = [item for item in loaded.reads if item in schema]
            cost.source = printable(loaded.source, 2 * MOST_CHARACTERS)
            return cost

    def close(self) -> None:
        """End the process."""
        with self._lock:
            self._stop()

    def _load(self, cost: WorkerCost) -> Loaded:
        self._start()
        schema = {key: [q.size, q.truth, q.constant] for key, q in cost.schema.items()}
        loaded = self._ask(Loaded, {"op": "load", "id": cost.number, "source": cost.given, "schema": schema})
        self._loaded -= set(loaded.dropped)
        self._loaded.add(cost.number)
        return loaded

    def _evaluate(self, cost: WorkerCost, state: Context) -> tuple[Ran, int]:
        sizes = {name: math.prod(state[name].shape) for name in cost.reads if name in state}
        inputs = sum(sizes.values())
        room = (MOST_TERMS + 1) * math.prod(state.shape)
        needed = 8 * (inputs + room)
        if needed > self._shared_bytes:
            self._stop()
            self._shared_bytes = needed
        self._start()
        if cost.number not in self._loaded:
            self._load(cost)
        listed, offset = [], 0
        for name in sizes:
            values = np.asarray(state[name], dtype=np.float64)
            size = cost.schema[name].size
            if values.ndim != (3 if size else 2) or (size and values.shape[2] != size):
                raise CostError("missing_state", f"{name} has shape {values.shape} in a batch of {state.shape}")
            parts = np.moveaxis(values, -1, 0) if size else values
            np.copyto(self._memory[offset : offset + values.size].reshape(parts.shape), parts)
            listed.append([name, offset, list(values.shape[:2]), size])
            offset += values.size
        run = {"op": "run", "id": cost.number, "shape": list(state.shape), "inputs": listed, "output": offset}
        return self._ask(Ran, run), offset

    def run(self, cost: WorkerCost, state: Context) -> Terms:
        """Evaluate a program.

        Raises:
            CostError: The program cannot be evaluated, is not finite, or killed its process.
        """
        with self._lock:
            ran, offset = self._evaluate(cost, state)
            names = ran.terms
            if len(set(names)) < len(names) or len(names) > MOST_TERMS or not all(map(is_term_name, names)):
                raise self._taken_over()
            terms: Terms = {}
            for name in names:
                end = offset + math.prod(state.shape)
                if end > self._memory.size:
                    raise self._taken_over()
                terms[name], offset = self._memory[offset:end].reshape(state.shape).copy(), end
            return terms

    def _start(self) -> None:
        if self._process is not None and self._process.poll() is None:
            return
        self._stop()
        descriptor = _unnamed_file(self._shared_bytes)
        shared = mmap(descriptor, self._shared_bytes)
        self._memory = np.frombuffer(shared, dtype=np.float64)
        environment = {name: os.environ[name] for name in KEPT_ENVIRONMENT if name in os.environ}
        environment |= {
            "PYTHONPATH": os.pathsep.join(path for path in sys.path if path),
            "OPENBLAS_NUM_THREADS": "1",
            "OMP_NUM_THREADS": "1",
        }
        command = [
            sys.executable,
            "-P",
            "-c",
            START,
            str(descriptor),
            str(self._shared_bytes),
            str(self.cfg.memory_bytes),
        ]
        try:
            process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                pass_fds=(descriptor,),
                env=environment,
                cwd="/",
                start_new_session=True,
            )
        finally:
            os.close(descriptor)
        self._process = process
        self._finalizer = weakref.finalize(self, _end, process)
        self._loaded.clear()
        self.starts += 1
        self.filtered = self._receive(Ready, time.monotonic() + self.cfg.start_s).filtered
        if not self.filtered and not self.cfg.allow_unfiltered:
            self._stop()
            raise InputError(
                "costs",
                "",
                "no filter of system calls (seccomp) on this machine",
                f"Linux on {' or '.join(MACHINES)}; set {ALLOW_UNFILTERED}=1 to run costs without it if you trust "
                "whoever writes them",
            )

    def check(self) -> bool:
        """Check whether the process starts and whether system calls are filtered on this machine."""
        with self._lock, contextlib.suppress(InputError, CostError, OSError):
            self._start()
        return self.filtered

    def _stop(self) -> None:
        if self._process is not None:
            if self._finalizer is not None:
                self._finalizer.detach()
            _end(self._process)
            self._process = None
        self._loaded.clear()

    def _ask(self, wanted: type[A], request: Request) -> A:
        assert self._process is not None
        assert self._process.stdin is not None
        body = json.dumps({**request, "cpu_s": self.cfg.cpu_s}).encode()
        try:
            self._process.stdin.write(HEADER.pack(len(body)) + body)
            self._process.stdin.flush()
        except OSError:
            raise self._died() from None
        return self._receive(wanted, time.monotonic() + self.cfg.wait_s)

    def _receive(self, wanted: type[A], until: float) -> A:
        size = HEADER.unpack(self._bytes(HEADER.size, until))[0]
        if size > LONGEST_MESSAGE:
            raise self._taken_over()
        body = self._bytes(size, until)
        try:
            if not body.startswith(b'{"error"'):
                return wanted.model_validate_json(body)
            code, text, line, shown = WorkerFailure.model_validate_json(body).error
        except ValueError:
            raise self._taken_over() from None
        raise CostError(code if code in CODES else "internal", text, line, shown[:200])

    def _taken_over(self) -> CostError:
        self._stop()
        return CostError("killed", "the process of the cost answered nonsense and was killed")

    def _bytes(self, size: int, until: float) -> bytes:
        assert self._process is not None
        assert self._process.stdout is not None
        descriptor, found = self._process.stdout.fileno(), b""
        while len(found) < size:
            ready, _, _ = select.select([descriptor], [], [], max(0.0, until - time.monotonic()))
            if not ready:
                self._stop()
                raise CostError("deadline", f"the cost gave no answer within {self.cfg.wait_s:g} s and was killed")
            piece = os.read(descriptor, size - len(found))
            if not piece:
                raise self._died()
            found += piece
        return found

    def _died(self) -> CostError:
        process = self._process
        code = process.wait(timeout=5.0) if process is not None else 0
        self._stop()
        if code == -signal.SIGPROF:
            return CostError(
                "deadline",
                f"the cost took more than {self.cfg.cpu_s:g} s of processor time and was killed; use fewer loops",
            )
        if code == -signal.SIGSYS:
            return CostError("killed", "the process of the cost asked for a system call that costs may not use")
        return CostError("killed", "the process of the cost died; it may have used too much memory")


class WorkerCost:
    """A cost program loaded in a worker. It satisfies `coral.contact.cost.context.Cost`."""

    def __init__(self, worker: CostWorker, number: int, given: str, schema: Schema, name: str) -> None:
        self.worker, self.number, self.given, self.name = worker, number, given, name
        self.schema = dict(schema)
        self.source = given
        self.reads: list[str] = []

    def __call__(self, state: Context) -> Terms:
        """Return the terms of every state, each Shape=(K, H).

        Raises:
            CostError: It cannot be evaluated, is not finite, or took its process down.
        """
        terms = self.worker.run(self, state)
        if not all(np.isfinite(term).all() for term in terms.values()):
            raise CostError("not_finite", "the cost is nan or infinite in some state")
        return terms


def _unnamed_file(size: int) -> int:
    if hasattr(os, "memfd_create"):
        descriptor = os.memfd_create("coral-cost")
    else:
        with tempfile.TemporaryFile() as file:
            descriptor = os.dup(file.fileno())
    os.ftruncate(descriptor, size)
    return descriptor


def _end(process: subprocess.Popen[bytes]) -> None:
    with contextlib.suppress(OSError):
        process.kill()
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(timeout=5.0)
    for stream in (process.stdin, process.stdout):
        if stream is not None:
            with contextlib.suppress(OSError):
                stream.close()
