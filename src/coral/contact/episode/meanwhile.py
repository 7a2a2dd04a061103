"""What a robot does while its next plan is computed: it keeps moving, in its own thread."""

from __future__ import annotations

import threading
from collections.abc import Callable
from types import TracebackType


class Meanwhile:
    """Takes steps in a thread for as long as a `with` block lasts, or until a step returns False.

    A block of planning spends its time in MuJoCo, which lets other threads run; a step spends it waiting for the robot.

    Attributes:
        steps: Steps taken in the last block.
    """

    def __init__(self, step: Callable[[], bool]) -> None:
        self._step = step
        self.steps = 0
        self._error: BaseException | None = None
        self._done = threading.Event()
        self._thread: threading.Thread | None = None

    def __enter__(self) -> Meanwhile:
        """Begin."""
        self.steps, self._error = 0, None
        self._done.clear()
        self._thread = threading.Thread(target=self._run, name="meanwhile", daemon=True)
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Wait for the end of the present step; raise what a step raised, unless the block failed itself."""
        self._done.set()
        if self._thread is not None:
            self._thread.join()
        if self._error is not None and error is None:
            raise self._error

    def _run(self) -> None:
        try:
            while not self._done.is_set():
                if not self._step():
                    return
                self.steps += 1
        except BaseException as error:
            self._error = error
