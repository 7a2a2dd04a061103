"""The clocks of a decision: simulated time, stepped by the mission, and wall time."""

from __future__ import annotations

import asyncio
import math
import sys
import time
from collections.abc import Callable, Coroutine
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np

from coral.advisor.inner_loop import run_on
from coral.advisor.latency import LatencyCfg, parse_latency
from coral.advisor.question import AdvisorUnavailable, Withdrawn
from coral.advisor.thread import AdvisorThread
from coral.interrupts import interruptible

R = TypeVar("R")

TINY_S = 1e-9
"""Ticks are multiples of 0.1 s in floating point: 0.3 + 10 and 103 * 0.1 are the same tick."""

MOST_STEPS = 100_000
"""Steps of the private loop after which a coroutine is assumed to wait for something that never comes in a tick."""


SWITCH_S = 0.0005
"""Longest time for which a thread that wants the interpreter waits for another one; Python's default is ten times as
long, and a control tick asks for it several times while a question is prepared."""


@dataclass
class _Request:
    """One pending request."""

    future: Future[Any]
    parked: asyncio.Future[Any]
    """Future on which the asking coroutine waits."""
    asked_s: float
    deadline_s: float
    asked_wall_s: float
    due_s: float | None
    """Time of delivery; None while only the reply can tell."""
    wait: bool
    """Whether simulated time stops until the advisor has answered."""
    wall_s: float = field(default=math.nan)
    """Wall time the advisor took, once it has answered."""


class SimulatedClock:
    """Simulated seconds, advanced by the mission's loop; no advisor can delay it in simulated time.

    Coroutines started here run on a private event loop inside `start` and `advance`, that is in the mission's thread
    and between two ticks: they may read the map without locks. The advisor runs on its own thread; its reply (or
    failure) is delivered at the first tick at or after `asked + latency`. With a drawn or recorded latency the outcome
    does not depend on the speed of machine and network: if the real answer is not there when it is due, simulated time
    stops until it is. With "measured", the latency is the advisor's wall time, and `advance` keeps simulated time from
    running ahead of it while a reply is outstanding.
    """

    def __init__(
        self,
        latency: str | LatencyCfg,
        rng: np.random.Generator,
        *,
        thread: AdvisorThread | None = None,
        wall_timeout_s: float = 600.0,
        paced: bool = True,
    ) -> None:
        """Start at time 0; replies take as long as a distribution such as "fixed:10" says, whose draws are from `rng`.

        `wall_timeout_s` is the longest wall time for which simulated time may stop for one reply (s). `paced`:
        `advance` may sleep to keep a measured latency true; False if the caller keeps time.
        """
        self.latency = parse_latency(latency) if isinstance(latency, str) else latency
        self._rng = rng
        self._own_thread = thread is None
        self.thread = thread or AdvisorThread()
        self._wall_timeout_s = wall_timeout_s
        self._paced = paced
        self._now_s = 0.0
        self.waited_s = 0.0
        """Wall time spent waiting for replies here, without the control loop's own work (s)."""
        self._loop = asyncio.new_event_loop()
        self._preparation = ThreadPoolExecutor(1, "coral-preparation")
        self._requests: list[_Request] = []
        self._tasks: list[asyncio.Task[Any]] = []

    def now(self) -> float:
        """Return simulated seconds since the start of the run."""
        return self._now_s

    @property
    def pending(self) -> bool:
        """Return whether a question is pending."""
        return bool(self._requests)

    def start(self, coroutine: Coroutine[Any, Any, R]) -> asyncio.Task[R]:
        """Run a coroutine (a `consult`) up to its first wait; with latency 0, to its end.

        Raises:
            Exception: Any exception of the coroutine.
        """
        task = self._loop.create_task(coroutine)
        self._tasks.append(task)
        self._run_until_idle()
        return task

    def advance(self, now_s: float) -> None:
        """Move to the next tick, deliver every reply that is due, and run what follows from it.

        Raises:
            Exception: Any exception of a started coroutine.
        """
        if now_s < self._now_s - TINY_S:
            raise ValueError(f"time runs backwards: from {self._now_s} to {now_s}")
        self._now_s = now_s
        if self._requests:
            if self._paced:
                self.pace()
            self._run_until_idle()

    def pace(self) -> None:
        """Sleep until wall time has caught up with simulated time, while a measured reply is outstanding."""
        for request in self._requests:
            if request.wait or request.due_s is not None or request.future.done():
                continue
            ahead = (self._now_s - request.asked_s) - (time.monotonic() - request.asked_wall_s)
            if ahead > 0:
                self.waited_s += ahead
                with interruptible():
                    time.sleep(ahead)

    async def reply(self, asking: Callable[[], Coroutine[Any, Any, R]], timeout_s: float) -> R:
        """Ask on the advisor thread and return the reply when it is due on this clock.

        Raises:
            TimeoutError: It was not due within `timeout_s` simulated seconds; the request is cancelled.
            Withdrawn: The question was withdrawn meanwhile.
            BadAnswer, AdvisorUnavailable: Raised by the advisor; it takes the same latency as an answer.
        """
        if timeout_s <= 0:
            raise TimeoutError
        latency = self.latency.draw(self._rng)
        waits = self._paced and self.latency.kind != "measured"
        result: R = await self._parked(self.thread.submit(asking), timeout_s, latency, wait=waits)
        return result

    async def prepare(self, work: Callable[[], R], after_s: float | None) -> R:
        """Run `work` on a thread for preparations, one after the other, and return its result.

        It may read only what this thread leaves as it is. The result is delivered after `after_s` simulated seconds,
        however fast the machine is; if it is not there then, simulated time stops until it is. 0: at once. None: as
        soon as it is there.

        Raises:
            Withdrawn: Everything pending was withdrawn meanwhile.
            Exception: Any exception of `work`.
        """
        sys.setswitchinterval(min(SWITCH_S, sys.getswitchinterval()))
        result: R = await self._parked(self._preparation.submit(work), math.inf, after_s, wait=after_s is not None)
        return result

    async def _parked(self, future: Future[Any], timeout_s: float, latency_s: float | None, *, wait: bool) -> Any:
        """Wait on this clock for work on another thread."""
        request = _Request(
            future=future,
            parked=self._loop.create_future(),
            asked_s=self._now_s,
            deadline_s=self._now_s + timeout_s,
            asked_wall_s=time.monotonic(),
            due_s=None if latency_s is None else self._now_s + latency_s,
            wait=wait,
        )

        def stamp(_: Future[Any]) -> None:
            request.wall_s = time.monotonic() - request.asked_wall_s

        request.future.add_done_callback(stamp)
        self._requests.append(request)
        try:
            return await request.parked
        finally:
            self._requests.remove(request)
            request.future.cancel()

    def stood_still(self, seconds: float) -> None:
        """Exclude a pause of `seconds` of wall time, ending now, from every latency under measurement.

        An advisor may continue during a pause of the run. Its reply then counts as given when the pause began.
        """
        began = time.monotonic() - seconds
        for request in self._requests:
            started = max(began, request.asked_wall_s)
            if math.isnan(request.wall_s):
                request.asked_wall_s += began + seconds - started
            else:
                request.wall_s = min(request.wall_s, started - request.asked_wall_s)

    def withdraw(self) -> None:
        """Cancel every pending request because its question is outdated; the asking coroutines end as withdrawn."""
        for request in self._requests:
            if not request.parked.done():
                request.parked.set_exception(Withdrawn())
        self._run_until_idle()

    def close(self) -> None:
        """End all coroutines and release the thread."""
        if self._loop.is_closed():
            return
        for task in self._tasks:
            task.cancel()
        if self._tasks:
            run_on(self._loop, self._ended())
        self._loop.close()
        self._preparation.shutdown(cancel_futures=True)
        if self._own_thread:
            self.thread.close()

    async def _ended(self) -> None:
        await asyncio.gather(*self._tasks, return_exceptions=True)

    def _run_until_idle(self) -> None:
        """Run the private loop until every coroutine has ended or waits for a reply that is not due."""
        try:
            while True:
                run_on(self._loop, self._until_parked())
                if not any(self._deliver(request) for request in self._requests):
                    break
        except (KeyboardInterrupt, SystemExit):
            # The loop raises these at once. Forget their tasks, or closing the run would raise them a second time.
            self._tasks = [task for task in self._tasks if not _interrupted(task)]
            raise
        ended = [task for task in self._tasks if task.done()]
        self._tasks = [task for task in self._tasks if not task.done()]
        for task in ended:
            if not task.cancelled() and (error := task.exception()) is not None:
                raise error

    async def _until_parked(self) -> None:
        for _ in range(MOST_STEPS):
            running = sum(not task.done() for task in self._tasks)
            if running <= sum(not request.parked.done() for request in self._requests):
                return
            await asyncio.sleep(0)
        raise RuntimeError("a coroutine started on this clock waits for something other than its reply()")

    def _deliver(self, request: _Request) -> bool:
        """Deliver one reply if it is due now, or its time-out."""
        future, parked = request.future, request.parked
        if parked.done():
            return False
        may_be_due = request.due_s is None or min(request.due_s, request.deadline_s) <= self._now_s + TINY_S
        if may_be_due and (request.due_s is None or request.due_s <= request.deadline_s + TINY_S):
            if request.wait and not future.done():
                began = time.monotonic()
                with interruptible():
                    # The robot's own work has no time-out: a run that was suspended for long continues.
                    wait([future], None if math.isinf(request.deadline_s) else self._wall_timeout_s)
                self.waited_s += time.monotonic() - began
                if not future.done():
                    late = f"no reply within {self._wall_timeout_s:g} s of wall time"
                    parked.set_exception(AdvisorUnavailable("wall-timeout", late))
                    return True
            if future.done():
                self._determine_due(request)
        due = request.due_s is not None and request.due_s <= min(self._now_s, request.deadline_s) + TINY_S
        if due and (request.wait or future.done()):
            result, error = _outcome(future)
            if error is None:
                parked.set_result(result)
            else:
                parked.set_exception(error)
            return True
        if request.deadline_s <= self._now_s + TINY_S:
            parked.set_exception(TimeoutError())
            return True
        return False

    def _determine_due(self, request: _Request) -> None:
        """Determine when a reply is due once it has arrived: a recorded reply may state its own latency."""
        result, error = _outcome(request.future)
        latency = getattr(result if error is None else error, "latency_s", None)
        if latency is not None:
            request.due_s = request.asked_s + latency
        elif request.due_s is None:
            if math.isnan(request.wall_s):
                request.wall_s = time.monotonic() - request.asked_wall_s
            request.due_s = request.asked_s + (0.0 if request.wait else request.wall_s)


def _interrupted(task: asyncio.Task[Any]) -> bool:
    """Check whether a coroutine was ended by an interrupt of the program."""
    return task.done() and not task.cancelled() and isinstance(task.exception(), KeyboardInterrupt | SystemExit)


def _outcome(future: Future[Any]) -> tuple[Any, BaseException | None]:
    """Return result and error of a finished request; one of them is None."""
    if future.cancelled():
        return None, AdvisorUnavailable("closed", "the advisor was shut down", final=True)
    error = future.exception()
    return (None, error) if error is not None else (future.result(), None)


class WallClock(SimulatedClock):
    """Wall seconds since creation or `restart`: for a real vehicle, whose control loop keeps its own period.

    Nothing waits for a reply: it is delivered when it is there.
    """

    def __init__(self, thread: AdvisorThread | None = None, latency: LatencyCfg | None = None) -> None:
        """Start at time 0; answers are given when they are there, but no earlier than the latency, if any."""
        latency = latency or LatencyCfg(kind="measured")
        super().__init__(latency, np.random.default_rng(0), thread=thread, paced=False)
        self.restart()

    def now(self) -> float:
        """Return wall seconds since this clock was made or restarted."""
        return time.monotonic() - self._start_s

    def restart(self) -> None:
        """Count from now: the mission that it serves begins. Before the first question only."""
        self._start_s, self._now_s = time.monotonic(), 0.0

    def start(self, coroutine: Coroutine[Any, Any, R]) -> asyncio.Task[R]:
        """Run a coroutine up to its first wait, in the thread of the control loop."""
        self.advance()
        return super().start(coroutine)

    def advance(self, now_s: float = 0.0) -> None:
        """Deliver what has arrived, without waiting; the time is this clock's own."""
        super().advance(self.now())

    async def prepare(self, work: Callable[[], R], after_s: float | None) -> R:
        """Run `work` on another thread, and return its result when it is there; `after_s` is for simulated time."""
        return await super().prepare(work, None)
