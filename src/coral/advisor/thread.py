"""The thread on which advisors run, so that the control loop never waits for a network."""

from __future__ import annotations

import asyncio
import contextlib
import threading
from collections.abc import Callable, Coroutine
from concurrent.futures import Future
from typing import Any

from coral.advisor.inner_loop import cancel_pending
from coral.advisor.question import trait


class AdvisorThread:
    """A daemon thread with its own event loop, which owns the connections of the advisors."""

    def __init__(self) -> None:
        self._loop = asyncio.new_event_loop()
        self._to_close: list[Callable[[], Coroutine[Any, Any, Any]]] = []
        self._thread = threading.Thread(target=self._run, name="coral-advisor", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        try:
            self._loop.run_forever()
        finally:
            cancel_pending(self._loop)
            for close in self._to_close:
                with contextlib.suppress(OSError, RuntimeError):
                    self._loop.run_until_complete(close())
            self._loop.run_until_complete(self._loop.shutdown_asyncgens())
            self._loop.close()

    def submit(self, asking: Callable[[], Coroutine[Any, Any, Any]]) -> Future[Any]:
        """Run a coroutine on the thread; cancelling the returned future cancels the coroutine.

        `asking` itself is called here, in the caller's thread: what an advisor decides before its first await (a random
        draw, the next line of a recording) happens in the order of the questions, independent of the thread's load.
        """
        return asyncio.run_coroutine_threadsafe(asking(), self._loop)

    def warm_up(self, advisor: Any, timeout_s: float = 60.0) -> None:
        """Let an advisor import and connect (its `warm_up` coroutine, if any) before the control loop starts.

        Its `aclose` coroutine, if any, runs when the thread is closed.

        The first call of a client library takes about 0.1 s and its import seconds; neither belongs in a control loop.

        Raises:
            TimeoutError: It took longer than `timeout_s` of wall time.
        """
        if (close := trait(advisor, "aclose")) is not None:
            self._to_close.append(close)
        warm = trait(advisor, "warm_up")
        future = self.submit(warm if warm is not None else _do_nothing)
        try:
            future.result(timeout_s)
        except TimeoutError:
            future.cancel()
            raise

    def close(self) -> None:
        """Cancel pending work and stop the thread."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._thread.join(timeout=5.0)


async def _do_nothing() -> None:
    """Do nothing; it returns once the loop runs."""
