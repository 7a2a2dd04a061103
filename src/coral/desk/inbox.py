"""The inbox as seen by the desk: the open questions, their content, and one answer to each."""

from __future__ import annotations

import contextlib
import json
import os
import re
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

from coral.advisor.parse import MAX_CHARS
from coral.desk.notice import change_file, is_alive
from coral.desk.schema import SchemaFault, faults
from coral.errors import InputError
from coral.file_writer import PRIVATE, write_whole, writing
from coral.foreign_file import parse_json, regular_bytes
from coral.odd_text import encodable

State = Literal["open", "sent", "answered", "withdrawn", "abandoned", "unreadable"]

ID = re.compile(r"\d{1,12}-[\w.-]{1,100}", re.ASCII)
MISSION = re.compile(r"[\w.-]{1,200}", re.ASCII)
INSTRUCTION_LIMIT = 1000
"""Characters of an instruction, as a mission in words takes them."""
QUESTION_LIMIT = 4_000_000
PICTURE_LIMIT = 16_000_000
"""Maximum size of a picture; anything larger was not written by a mission."""
MAX_BRACKETS = 300
"""Maximum number of brackets in an answer shown as a value; Python cannot print much deeper nesting."""
NOTICE_KEYS = (
    *("state", "outcome", "doing", "instruction", "world", "advisor", "variant", "seed", "run", "started_at"),
)
PNG_MAGIC = b"\x89PNG\r\n\x1a\n"


class NoSuchQuestion(LookupError):
    """There is no such question, or it has no such picture."""


class NotOpen(Exception):
    """The question can no longer be answered, or the mission not be changed; the message says why."""


class Unfit(Exception):
    """The answer does not fit the question's schema."""

    def __init__(self, found: list[SchemaFault]) -> None:
        super().__init__("; ".join(f"{fault.place or 'the answer'} {fault.reason}" for fault in found))
        self.faults = found


@dataclass(frozen=True, kw_only=True)
class InboxEntry:
    """One question in the inbox, in brief."""

    id: str
    kind: str
    state: State
    """open: waits for an answer; sent: answered, not yet fetched; answered: fetched; withdrawn: the mission no longer
    needs it; abandoned: the mission that asked is gone; unreadable: not a question."""
    asked_at: float | None = None
    """Unix time (s)."""
    attempt: int = 0
    """Number of refused answers before this question."""
    operator: str = ""
    """Name of the person who answered here; "" if unknown."""
    answer: Any = None
    refused: str = ""
    """Reason why the answer was refused, if the mission's next question states it."""


class Inbox:
    """Reads and answers the questions in one folder. Safe to use from several threads and beside other programs."""

    def __init__(self, folder: Path) -> None:
        """Open a folder of questions; it is created if it does not exist: the desk may be opened before the mission.

        Raises:
            InputError: It is not a folder, or cannot be made, read or written.
        """
        self.folder = folder
        if folder.exists() and not folder.is_dir():
            raise InputError(str(folder), "INBOX", "a file", "a folder")
        with writing(folder, "INBOX", "a folder that can be written"):
            folder.mkdir(PRIVATE, parents=True, exist_ok=True)
        if not os.access(folder, os.R_OK | os.W_OK | os.X_OK):
            raise InputError(str(folder), "INBOX", "a folder without access", "a folder that can be read and written")
        self._settled: dict[str, tuple[InboxEntry, str]] = {}
        self._questions: dict[str, Mapping[str, Any]] = {}

    def entries(self) -> list[InboxEntry]:
        """Return all questions in the order of asking."""
        found: list[InboxEntry] = []
        last: dict[str, int] = {}
        for question_id in sorted(self._ids(), key=lambda name: (int(name.partition("-")[0]), name)):
            entry, asker = self._entry(question_id)
            if entry.attempt and asker in last:
                before = found[last[asker]]
                if before.answer is not None:
                    found[last[asker]] = replace(before, refused=self._last_refusal(question_id))
            if entry.state != "withdrawn":
                last[asker] = len(found)
            found.append(entry)
        return found

    def missions(self) -> list[dict[str, Any]]:
        """Return the notices of missions, the latest started last; those that ended without a notice are "stopped"."""
        notices = []
        for path in self.folder.glob("mission-*.json"):
            notice = _read_object(path)
            if notice is None:
                continue
            if notice.get("state") == "running" and not _asker_lives(notice):
                notice["state"] = "stopped"
            notices.append({"id": path.stem.removeprefix("mission-")} | {key: notice.get(key) for key in NOTICE_KEYS})
        return sorted(notices, key=lambda notice: _number(notice["started_at"]) or 0.0)

    def instruct(self, mission_id: str, instruction: str, operator: str = "") -> None:
        """Give a mission in words another instruction, which it takes in a moment; the last one counts.

        Raises:
            NoSuchQuestion: There is no such mission.
            NotOpen: It has ended, or it has no instruction.
            ValueError: There are no words, or too many.
        """
        if not instruction.strip() or len(instruction) > INSTRUCTION_LIMIT:
            raise ValueError(f"An instruction has some words, at most {INSTRUCTION_LIMIT} characters.")
        mission = next((one for one in self.missions() if one["id"] == mission_id), None)
        if mission is None or not MISSION.fullmatch(mission_id):
            raise NoSuchQuestion(mission_id)
        if mission["state"] != "running":
            raise NotOpen("The mission has ended.")
        if not isinstance(mission["instruction"], str) or not mission["instruction"]:
            raise NotOpen("The mission has no instruction in words to change.")
        content = encodable(json.dumps({"instruction": instruction, "operator": operator}, ensure_ascii=False))
        write_whole(change_file(self.folder / f"mission-{mission_id}.json"), content)

    def question(self, question_id: str) -> Mapping[str, Any]:
        """Return a question as it was asked: the content of its question.json.

        Raises:
            NoSuchQuestion: There is none with this name.
        """
        content = self._questions.get(question_id)
        if content is None:
            content = _read_object(self._folder_of(question_id) / "question.json")
            if content is None or not isinstance(content.get("answer_schema"), dict):
                raise NoSuchQuestion(question_id)
            self._questions[question_id] = content
        return content

    def picture(self, question_id: str, name: str) -> bytes:
        """Return a picture of a question, PNG.

        Raises:
            NoSuchQuestion: The question lists no such picture, or it is no PNG.
        """
        images = self.question(question_id).get("images")
        if not isinstance(images, list) or name not in images or Path(name).name != name or name.startswith("."):
            raise NoSuchQuestion(f"{question_id}/{name}")
        content = _read_bytes(self._folder_of(question_id) / name, PICTURE_LIMIT)
        if content is None or not content.startswith(PNG_MAGIC):
            raise NoSuchQuestion(f"{question_id}/{name}")
        return content

    def answer(self, question_id: str, answer: Any, operator: str = "") -> None:
        """Answer a question with a value as `json.loads` returns it, unless it is already answered.

        The answer is published atomically, and only one of several simultaneous answers is.

        Raises:
            NoSuchQuestion: There is none with this name.
            Unfit: The answer does not fit its schema.
            NotOpen: It is answered already, or no longer needed.
        """
        question, folder = self.question(question_id), self._folder_of(question_id)
        self._refuse_closed(question_id)
        wrong = faults(answer, question["answer_schema"])
        text = encodable(json.dumps(answer, ensure_ascii=False))
        if not wrong and len(text) > MAX_CHARS:
            wrong = [SchemaFault((), f"has {len(text)} characters; at most {MAX_CHARS} are read")]
        if wrong:
            raise Unfit(wrong)
        try:
            write_whole(folder / "answer.json", text, replace=False)
        except FileExistsError:
            raise NotOpen(_taken_text(folder)) from None
        write_whole(folder / "operator.json", json.dumps({"operator": operator, "answered_at": round(time.time(), 3)}))

    def _refuse_closed(self, question_id: str) -> None:
        entry, _ = self._entry(question_id)
        folder = self._folder_of(question_id)
        if entry.state in ("sent", "answered"):
            raise NotOpen(_taken_text(folder))
        if entry.state == "withdrawn":
            raise NotOpen("The mission withdrew this question: it no longer needs an answer.")
        if entry.state == "abandoned":
            raise NotOpen("The mission that asked has stopped: nobody would read the answer.")

    def _ids(self) -> list[str]:
        try:
            with os.scandir(self.folder) as listing:
                return [item.name for item in listing if ID.fullmatch(item.name) and item.is_dir(follow_symlinks=False)]
        except OSError:
            return []

    def _folder_of(self, question_id: str) -> Path:
        folder = self.folder / question_id
        if not ID.fullmatch(question_id) or folder.is_symlink() or not folder.is_dir():
            raise NoSuchQuestion(question_id)
        return folder

    def _entry(self, question_id: str) -> tuple[InboxEntry, str]:
        """Return a question in brief, and its asker; a question in a final state is read only once."""
        if question_id in self._settled:
            return self._settled[question_id]
        try:
            question, folder = self.question(question_id), self._folder_of(question_id)
        except NoSuchQuestion:
            return InboxEntry(id=question_id, kind=question_id.partition("-")[2], state="unreadable"), question_id
        asker = question.get("asker")
        rejections = question.get("rejections")
        # Read the closing first: an answer found afterwards existed before it.
        closed = _read_object(folder / "closed.json")
        answered = (folder / "answer.json").exists()
        state: State = "open"
        if closed is not None:
            state = "answered" if closed.get("state") == "answered" else "withdrawn"
        elif answered:
            state = "sent"
        elif isinstance(asker, dict) and not _asker_lives(asker):
            state = "abandoned"
        by = _read_object(folder / "operator.json") or {}
        entry = InboxEntry(
            id=question_id,
            kind=str(question.get("kind", "")),
            state=state,
            asked_at=_number(question.get("asked_at")),
            attempt=len(rejections) if isinstance(rejections, list) else 0,
            operator=str(by.get("operator", "")),
            answer=_answer_for_history(folder / "answer.json") if answered else None,
        )
        key = json.dumps(asker, sort_keys=True)
        if closed is not None:
            # The operator is recorded shortly after the answer; after that the question never changes.
            with contextlib.suppress(OSError):
                if by or state == "withdrawn" or time.time() - (folder / "closed.json").stat().st_mtime > 5.0:
                    self._settled[question_id] = (entry, key)
        return entry, key

    def _last_refusal(self, question_id: str) -> str:
        rejections = self.question(question_id)["rejections"]
        return str(rejections[-1].get("reason", "")) if isinstance(rejections[-1], dict) else str(rejections[-1])


def _taken_text(folder: Path) -> str:
    by = (_read_object(folder / "operator.json") or {}).get("operator")
    return f"This question is already answered by {by or 'somebody else'}."


def _asker_lives(asker: Mapping[str, Any]) -> bool:
    host, pid = asker.get("host"), asker.get("pid")
    return is_alive(host, pid) if isinstance(host, str) and isinstance(pid, int) and pid > 0 else True


def _read_bytes(path: Path, limit: int) -> bytes | None:
    """Read a plain file of at most `limit` bytes; None if it is not one."""
    try:
        content = b"" if path.is_symlink() else regular_bytes(path, limit)
        return content if 0 < len(content) <= limit else None
    except OSError:
        return None


def _answer_for_history(path: Path) -> Any:
    """Return an answer for the history; an unacceptable one is shortened to the start of its text."""
    text = (_read_bytes(path, QUESTION_LIMIT) or b"").decode("utf-8", "replace")
    simple = len(text) <= MAX_CHARS and text.count("[") + text.count("{") <= MAX_BRACKETS
    return _read_any(path) if simple else text[:400]


def _read_any(path: Path) -> Any:
    """Read a JSON file; if it is not JSON, as another program's answer may be, return its text."""
    content = _read_bytes(path, QUESTION_LIMIT)
    if content is None:
        return None
    text = content.decode("utf-8", "replace")
    try:
        return parse_json(text, constant=str)
    except (ValueError, RecursionError):
        return text[:400]


def _read_object(path: Path) -> dict[str, Any] | None:
    """Read the object in a JSON file; None if there is none."""
    content = _read_any(path)
    return content if isinstance(content, dict) else None


def _number(value: Any) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    with contextlib.suppress(OverflowError):
        return float(value)
    return None
