"""A mission's notice in the inbox for the people at the desk: that it runs, and how it ended."""

from __future__ import annotations

import contextlib
import json
import os
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from coral.file_writer import PRIVATE, write_whole


class MissionNotice:
    """The notice of one mission."""

    def __init__(self, path: Path, content: dict[str, Any]) -> None:
        self._path, self._content = path, content
        self.tell()

    def tell(self, **news: Any) -> None:
        """Write the notice, with news."""
        self._content.update(news)
        _write(self._path, self._content)

    def doing(self, text: str) -> None:
        """Tell what the vehicle is doing."""
        self.tell(doing=text)

    def finished(self, outcome: str) -> None:
        """Tell how the mission ended, as a sentence."""
        self.tell(state="finished", outcome=outcome, doing="")

    @property
    def running(self) -> bool:
        """Whether nobody has told how it ended."""
        return bool(self._content["state"] == "running")


@contextmanager
def mission_notice(inbox: Path, **about: Any) -> Iterator[MissionNotice]:
    """Keep a `mission-HOST-PID.json` in an inbox while a mission runs, and leave it there with its outcome.

    A mission that ends without telling its outcome has failed. The notice is optional: an inbox that cannot be written
    does not stop the mission.

    Args:
        inbox: Folder of questions; created if it does not exist.
        about: Description of the mission, such as its world and its run folder; JSON values.
    """
    host, pid = socket.gethostname(), os.getpid()
    content = {
        **about,
        "host": host,
        "pid": pid,
        "state": "running",
        "outcome": "",
        "doing": "",
        "started_at": round(time.time(), 3),
    }
    notice = MissionNotice(inbox / f"mission-{host}-{pid}.json", content)
    try:
        yield notice
    finally:
        if notice.running:
            notice.tell(state="failed")
        notice.tell(ended_at=round(time.time(), 3))


def is_alive(host: str, pid: int) -> bool:
    """Check whether a process runs; True for another machine, where this cannot be checked."""
    if host != socket.gethostname():
        return True
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except (PermissionError, OverflowError):
        return True
    return True


def _write(path: Path, content: dict[str, Any]) -> None:
    with contextlib.suppress(OSError):
        path.parent.mkdir(PRIVATE, parents=True, exist_ok=True)
        write_whole(path, json.dumps(content, indent=2, default=str))
