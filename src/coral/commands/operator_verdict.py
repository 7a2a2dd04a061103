"""The operator's verdict on an episode, from the keyboard."""

from __future__ import annotations

import os
import select
import sys
from typing import Literal, TextIO

from coral.terminal import tell

VERDICTS: dict[str, Literal["success", "failure"]] = {"s": "success", "f": "failure"}
HINT = "Judge the episode: s and Enter for success, f and Enter for failure."


class KeyboardVerdict:
    """Reads the verdict without waiting for it: a line that is `s` or `f` from a file, by default standard input."""

    def __init__(self, stream: TextIO | None = None) -> None:
        self._file: int | None = (stream or sys.stdin).fileno()
        self._begun = b""

    def __call__(self) -> Literal["success", "failure", ""]:
        """Return the verdict; "" if there is none yet. Other lines get the hint on standard error."""
        # Bytes and not lines are read: a line in the stream's buffer would be invisible to select.
        while self._file is not None and select.select([self._file], [], [], 0)[0]:
            found = os.read(self._file, 4096)
            if not found:  # closed: no verdict will come
                self._file = None
            self._begun += found
        while b"\n" in self._begun:
            line, _, self._begun = self._begun.partition(b"\n")
            word = line.decode(errors="replace").strip().lower()
            if word in VERDICTS:
                return VERDICTS[word]
            tell(HINT)
        return ""
