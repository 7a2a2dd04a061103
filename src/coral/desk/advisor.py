"""The inbox advisor: a person or a program answers; each open question is a folder."""

from __future__ import annotations

import asyncio
import dataclasses
import json
import os
import secrets
import socket
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel

from coral.advisor.log import plain_json
from coral.advisor.parse import MAX_CHARS, parse_answer
from coral.advisor.question import AdvisorUnavailable, BadAnswer, Question, Rejection, Reply, Usage
from coral.advisor.setting import Setting
from coral.errors import InputError
from coral.file_writer import PRIVATE, write_whole
from coral.foreign_file import NotRegularError, open_regular

A = TypeVar("A", bound=BaseModel)

WRITING = ".writing"
"""Folder of an inbox in which questions are written before they are published."""
ROOT = 0
MAX_BYTES = 4 * MAX_CHARS + 4
"""More of an answer is not read: it is too long in any case."""


class DeskAdvisor:
    """Puts each question into `INBOX/<id>/question.json` with its PNGs, and waits for `answer.json` beside it.

    A folder appears complete (written in `INBOX/.writing/`, then renamed) and gets a `closed.json` when its question is
    no longer open: answered, or withdrawn because the world changed. `answer.json` must be written elsewhere and
    renamed too. The folders are private, and an answer counts only if it is a file of the same user.
    """

    latency = "measured"
    name = "desk"

    def __init__(self, inbox: Path, poll_s: float = 0.1) -> None:
        """Open an inbox, looked at for answers every `poll_s` (s, wall).

        The folder is created with the first question if it does not exist, so that it may lie in a run folder that does
        not exist yet.

        Raises:
            InputError: The folder cannot be written.
        """
        self._inbox, self._poll_s = inbox, poll_s
        nearest = next(path for path in (inbox.absolute(), *inbox.absolute().parents) if path.exists())
        if not nearest.is_dir() or not os.access(nearest, os.W_OK | os.X_OK):
            found = "a folder that cannot be written" if nearest.is_dir() else f"a file ({nearest})"
            raise InputError(str(inbox), "--inbox", found, "a folder that can be written")

    async def answer(self, question: Question[A], rejections: Sequence[Rejection]) -> Reply[A]:
        """Post the question and wait until it is answered.

        Raises:
            BadAnswer: The answer does not validate, or is not of the same user ("not-yours").
            AdvisorUnavailable: The inbox cannot be written.
        """
        try:
            folder = self._post(question, rejections)
        except OSError as error:
            raise AdvisorUnavailable("desk", f"the inbox cannot be written: {error.strerror}", final=True) from None
        state = "withdrawn"
        try:
            file = folder / "answer.json"
            while not file.exists():
                await asyncio.sleep(self._poll_s)
            state = "answered"
            text = read_answer(file)
        finally:
            write_whole(folder / "closed.json", json.dumps({"state": state}))
        if text is None:
            raise BadAnswer("not-yours", "answer.json is no file of the user who asks; answer with one.")
        usage = Usage(requests=1)
        return Reply(value=parse_answer(text, question.answer_type, usage), raw=text, usage=usage)

    def _post(self, question: Question[Any], rejections: Sequence[Rejection]) -> Path:
        """Write a question folder, numbered with the first free number."""
        self._inbox.mkdir(PRIVATE, parents=True, exist_ok=True)
        numbers = [int(p.name.partition("-")[0]) for p in self._inbox.iterdir() if p.name.partition("-")[0].isdigit()]
        number = max(numbers, default=0) + 1
        name = f"{number:06d}-{question.kind}"
        # One level below, where the pattern */question.json of a program that watches the inbox does not match it.
        aside = self._inbox / WRITING / f"{name}.{os.getpid()}.{secrets.token_hex(4)}"
        content = _write_question(aside, question, name, rejections)
        while True:
            try:
                # A rename onto a non-empty folder fails: two missions may share an inbox.
                os.rename(aside, self._inbox / name)
                return self._inbox / name
            except OSError:
                if not (self._inbox / name).exists():
                    raise
                number += 1
                name = f"{number:06d}-{question.kind}"
                content["id"] = name
                write_whole(aside / "question.json", plain_json(content, indent=2))


def _write_question(
    folder: Path, question: Question[Any], name: str, rejections: Sequence[Rejection]
) -> dict[str, Any]:
    """Write a question and its PNGs into a new folder; return the contents of `question.json`."""
    folder.mkdir(PRIVATE, parents=True)
    for picture in question.pictures:
        write_whole(folder / f"{picture.name}.png", picture.png)
    content = {
        "id": name,
        "kind": question.kind,
        "prompt": question.prompt,
        "prompt_version": question.prompt_version,
        "answer_schema": question.answer_type.model_json_schema(),
        "images": [f"{picture.name}.png" for picture in question.pictures],
        "captions": [picture.caption for picture in question.pictures],
        "picture_frames": {
            f"{picture.name}.png": {"pixel_from_world": picture.pixel_from_world}
            for picture in question.pictures
            if picture.pixel_from_world is not None
        },
        "facts": question.facts,
        "asked_at": round(time.time(), 3),
        "asker": {"host": socket.gethostname(), "pid": os.getpid()},
        "rejections": [dataclasses.asdict(r) for r in rejections],
    }
    write_whole(folder / "question.json", plain_json(content, indent=2))
    return content


def read_answer(file: Path) -> str | None:
    """Read an answer; None if it is not a regular file of this user (or of root, who can do anything anyway).

    Raises:
        OSError: It cannot be read.
    """
    user = getattr(os, "geteuid", lambda: ROOT)()
    if file.is_symlink():
        return None
    try:
        with open_regular(file, follow=False) as opened:
            mine = os.fstat(opened.fileno()).st_uid in (user, ROOT)
            return opened.read(MAX_BYTES).decode("utf-8", "replace") if mine else None
    except NotRegularError:
        return None


def make_desk(name: str, rest: str, setting: Setting) -> DeskAdvisor:
    """Make the inbox advisor.

    Raises:
        InputError: There is no inbox, or it cannot be written.
    """
    if setting.inbox is None:
        raise InputError(setting.where, "", "desk without an inbox", "a folder for its questions (--inbox DIR)")
    return DeskAdvisor(setting.inbox)
