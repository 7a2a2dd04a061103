"""A mission's notice in the inbox for the people at the desk: that it runs, what it is to do, and how it ended.

The instruction of a mission in words may be changed there: the desk writes `instruction-HOST-PID.json`, the mission
takes it.
"""

from __future__ import annotations

import contextlib
import json
import os
import socket
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from coral.desk.advisor import read_answer
from coral.errors import InputError
from coral.file_writer import PRIVATE, write_whole
from coral.foreign_file import parse_json

Instruct = Callable[[str, str], bool]
"""instruct(words, by) changes the instruction of a mission in words, from any thread."""
NAME_LIMIT = 60
"""Letters of an operator's name."""
LOOK_S = 0.3
"""Interval of looking for another instruction (s)."""


class MissionNotice:
    """The notice of one mission."""

    def __init__(self, path: Path, content: dict[str, Any], instruct: Instruct | None = None) -> None:
        self._path, self._content, self._instruct = path, content, instruct
        self._writing = threading.Lock()
        self.tell()

    def tell(self, **news: Any) -> None:
        """Write the notice, with news."""
        with self._writing, contextlib.suppress(OSError):
            self._content.update(news)
            self._path.parent.mkdir(PRIVATE, parents=True, exist_ok=True)
            write_whole(self._path, json.dumps(self._content, indent=2, default=str))

    def hear(self, event: Mapping[str, Any]) -> None:
        """Tell what an event of the mission says of its state and its instruction."""
        if event["event"] in ("state", "awaited"):
            told = (event["state"], event["reason"], event.get("ends_when", ""))
            self.tell(doing=" - ".join(text for text in told if text))
        elif event["event"] == "instruction":
            self.tell(instruction=event["text"])

    def take_instruction(self) -> None:
        """Take over an instruction that was changed at the desk. Only a file of the same user counts."""
        change = change_file(self._path)
        taken = change.with_suffix(".taken")
        with contextlib.suppress(OSError, ValueError, InputError):
            os.replace(change, taken)
            text = read_answer(taken)
            taken.unlink()
            told = parse_json(text or "")
            if self._instruct is not None and isinstance(told, dict) and isinstance(told.get("instruction"), str):
                by = str(told.get("operator") or "somebody")[:NAME_LIMIT]
                self._instruct(told["instruction"], f"{by} at the desk")

    def finished(self, outcome: str) -> None:
        """Tell how the mission ended, as a sentence."""
        self.tell(state="finished", outcome=outcome, doing="")

    @property
    def running(self) -> bool:
        """Whether nobody has told how it ended."""
        return bool(self._content["state"] == "running")


@contextmanager
def mission_notice(inbox: Path, instruct: Instruct | None = None, **about: Any) -> Iterator[MissionNotice]:
    """Keep a `mission-HOST-PID.json` in an inbox while a mission runs, and leave it there with its outcome.

    A mission that ends without telling its outcome has failed. The notice is optional: an inbox that cannot be written
    does not stop the mission. `about` describes the mission, such as its world and its run folder, in JSON values.
    """
    host, pid = socket.gethostname(), os.getpid()
    content = {**about, "host": host, "pid": pid, "state": "running", "outcome": "", "doing": ""}
    path, over = inbox / f"mission-{host}-{pid}.json", threading.Event()
    notice = MissionNotice(path, {**content, "started_at": round(time.time(), 3)}, instruct)

    def look() -> None:
        while not over.wait(LOOK_S):
            notice.take_instruction()

    with contextlib.suppress(OSError):
        change_file(path).unlink()  # for an earlier process of this number
    if instruct is not None:
        threading.Thread(target=look, name="coral-desk", daemon=True).start()
    try:
        yield notice
    finally:
        over.set()
        if notice.running:
            notice.tell(state="failed")
        notice.tell(ended_at=round(time.time(), 3))


def change_file(notice: Path) -> Path:
    """Return where the desk puts another instruction for the mission of a notice."""
    return notice.with_name(f"instruction-{notice.name.removeprefix('mission-')}")


def is_alive(host: str, pid: int) -> bool:
    """Check whether a process runs; True for another machine, where this cannot be checked."""
    if host != socket.gethostname():
        return True
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except (PermissionError, OverflowError):
        pass
    return True
