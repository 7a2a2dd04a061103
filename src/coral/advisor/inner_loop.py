"""Running a coroutine to its end although an event loop may already be running, as in a notebook's cell."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Awaitable, Coroutine, Iterator
from typing import Any, TypeVar

R = TypeVar("R")


def run_on(loop: asyncio.AbstractEventLoop, awaitable: Awaitable[R]) -> R:
    """Run `loop.run_until_complete(awaitable)`, also while another loop runs in this thread; that one is suspended.

    Everything stays in the caller's thread, so the coroutine may use objects of that thread.

    Raises:
        RuntimeError: `loop` itself is running.
    """
    with _suspend_outer_loop():
        return loop.run_until_complete(awaitable)


def run_alone(coroutine: Coroutine[Any, Any, R]) -> R:
    """Run `asyncio.run(coroutine)`, also while another loop runs in this thread, on a loop of its own."""
    with _suspend_outer_loop(), asyncio.Runner(loop_factory=asyncio.new_event_loop) as runner:
        return runner.run(coroutine)


def cancel_pending(loop: asyncio.AbstractEventLoop) -> None:
    """Cancel the tasks that wait on a loop, as after Ctrl-C, and let them end."""
    left = asyncio.all_tasks(loop)
    for task in left:
        task.cancel()
    if left:
        run_on(loop, asyncio.gather(*left, return_exceptions=True))


@contextlib.contextmanager
def _suspend_outer_loop() -> Iterator[None]:
    """Detach the running loop and its task from the thread temporarily.

    Python refuses to run a second loop in a thread only because the first one is registered there; asyncio offers these
    functions to implementers of event loops.
    """
    outer = asyncio._get_running_loop()
    if outer is None:
        yield
        return
    task = asyncio.current_task(outer)
    if task is not None:
        asyncio.tasks._leave_task(outer, task)
    asyncio._set_running_loop(None)
    try:
        yield
    finally:
        asyncio._set_running_loop(outer)
        if task is not None:
            asyncio.tasks._enter_task(outer, task)
