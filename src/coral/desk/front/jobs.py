"""Runs that the front page has started: `coral` commands in processes of their own, with what they say."""

from __future__ import annotations

import re
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Sequence
from pathlib import Path

MOST = 4
"""Runs at once: each needs a core."""
_WATCH = re.compile(r"at (http://127\.0\.0\.1:\d+/\S+)")


class Job:
    """One command, given without `coral`, writing a run folder."""

    def __init__(self, words: Sequence[str], folder: Path) -> None:
        self.words, self.folder = tuple(words), folder
        self.url = ""
        """Its live page, once it has said where that is."""
        self._told: deque[str] = deque(maxlen=20)
        self._process = subprocess.Popen(
            [sys.executable, "-m", "coral", *words],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            errors="replace",
        )
        self._reader = threading.Thread(target=self._listen, daemon=True)
        self._reader.start()

    @property
    def running(self) -> bool:
        """Return whether it has not ended."""
        return self._process.poll() is None

    @property
    def code(self) -> int | None:
        """Return its exit code; None while it runs."""
        return self._process.poll()

    @property
    def told(self) -> str:
        """Return its last lines on standard error, for people."""
        return "\n".join(self._told)

    def stop(self, patience_s: float = 0.0) -> None:
        """Tell it to end, so that its folder is complete; after the patience (s), if there is any, it is killed.

        By SIGTERM: what a shell starts in the background hands down that Ctrl-C is ignored.
        """
        if self.running:
            self._process.terminate()
        if patience_s:
            try:
                self._process.wait(patience_s)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
            self._reader.join(1.0)

    def _listen(self) -> None:
        assert self._process.stderr is not None
        for line in self._process.stderr:
            found = _WATCH.search(line)
            if found:
                self.url = found[1]
            else:
                self._told.append(line.rstrip()[:400])
        self._process.stderr.close()
