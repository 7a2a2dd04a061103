"""The operator's words, from keyboard and page, and the orders to the vehicle that follow from them."""

from __future__ import annotations

import queue
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Literal

from coral.errors import first_line
from coral.reef.sea.link import LinkRefused, VehicleLink

Word = Literal["arm", "hold", "resume", "home", "stop", "surface", "disarm"]
WORDS: dict[Word, str] = {
    "arm": "Let the survey begin.",
    "hold": "Stay here; the survey waits.",
    "resume": "Continue after a hold, a limit, or a person at the joystick.",
    "home": "Return to the start, around what is on the map; then as `--safety.after-return` says.",
    "stop": "End the survey, and hold.",
    "surface": "End the survey, and come up.",
    "disarm": "Stop the thrusters, now.",
}
"""What the operator may say."""
Order = Literal["arm", "hold", "surface", "disarm"]


class OperatorWords:
    """Collects what the operator says, on any thread, until the control loop takes it."""

    def __init__(self) -> None:
        self._said: queue.SimpleQueue[tuple[Word, str]] = queue.SimpleQueue()

    def say(self, word: Word, source: str) -> None:
        """Say a word; `source` names the keyboard, the page or the signal."""
        self._said.put((word, source))

    def take(self) -> list[tuple[Word, str]]:
        """Return what was said since the last call, oldest first."""
        return [self._said.get_nowait() for _ in range(self._said.qsize())]


@dataclass(frozen=True)
class OrderResult:
    """What became of an order."""

    order: Order
    refusal: str = ""
    """The vehicle's words, or "" if it obeyed."""


class VehicleOrders:
    """Gives orders to the vehicle off the control thread, since the vehicle may take seconds to confirm them.

    A new order replaces one that has not begun.
    """

    def __init__(self, link: VehicleLink, *, threaded: bool = True) -> None:
        """Set up; without `threaded` an order is carried out at once, for tests."""
        self._link = link
        self._thread = ThreadPoolExecutor(1, "coral-orders") if threaded else None
        self._given: list[tuple[Order, Future[None]]] = []
        self._results: queue.SimpleQueue[OrderResult] = queue.SimpleQueue()

    @property
    def pending(self) -> Order | None:
        """The order that waits or is under way."""
        self._given = [(order, outcome) for order, outcome in self._given if not outcome.done()]
        return self._given[-1][0] if self._given else None

    def give(self, order: Order) -> None:
        """Give an order; return at once."""
        if order == self.pending:
            return
        for _, outcome in self._given:
            outcome.cancel()
        if self._thread is None:
            self._carry_out(order)
        else:
            self._given.append((order, self._thread.submit(self._carry_out, order)))

    def results(self) -> list[OrderResult]:
        """Return what became of orders since the last call."""
        return [self._results.get_nowait() for _ in range(self._results.qsize())]

    def wait(self, timeout_s: float, sleep: Callable[[float], None]) -> None:
        """Wait until no order is pending, at the end of a survey."""
        for _ in range(int(timeout_s / 0.05)):
            if self.pending is None:
                return
            sleep(0.05)

    def close(self) -> None:
        """End the thread when the order under way is finished; nothing waits for that here."""
        if self._thread is not None:
            self._thread.shutdown(wait=False)

    def _carry_out(self, order: Order) -> None:
        try:
            getattr(self._link, order)()
            result = OrderResult(order)
        except LinkRefused as refused:
            result = OrderResult(order, str(refused))
        except Exception as error:  # an order must never end the thread that gives the next one
            result = OrderResult(order, first_line(error))
        self._results.put(result)
