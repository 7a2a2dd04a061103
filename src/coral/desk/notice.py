"""A mission's notice in the inbox for the people at the desk: that it runs, and how it ended."""

from __future__ import annotations

import json
import os
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any


@contextmanager
def mission_notice(inbox: Path, **about: Any) -> Iterator[Callable[[str], None]]:
    """Keep a `mission-HOST-PID.json` in an inbox while a mission runs, and leave it there with its outcome.

    It yields a function that takes the outcome as a sentence; a mission that ends without calling it has failed. The
    notice is optional: an inbox that cannot be written does not stop the mission.

    Args:
        inbox: Folder of questions; created if it does not exist.
        about: Description of the mission, such as its world and its run folder; JSON values.
    """
    host, pid = socket.gethostname(), os.getpid()
    notice: dict[str, Any] = {
        **about,
        "host": host,
        "pid": pid,
        "state": "running",
        "outcome": "",
        "started_at": round(time.time(), 3),
    }
    path = inbox / f"mission-{host}-{pid}.json"

    def finished(outcome: str) -> None:
        notice.update(state="finished", outcome=outcome)

    _write(path, notice)
    try:
        yield finished
    finally:
        if notice["state"] == "running":
            notice["state"] = "failed"
        _write(path, {**notice, "ended_at": round(time.time(), 3)})


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
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        partial = path.with_name(f".{path.name}.part")
        partial.write_text(json.dumps(content, indent=2, default=str), encoding="utf-8")
        os.replace(partial, path)
    except OSError:
        pass
