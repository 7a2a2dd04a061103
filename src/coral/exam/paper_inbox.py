"""A set exported as a desk inbox: one folder per question, for a person or any program to answer at any time."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from coral.advisor.desk import question_folder, read_answer
from coral.advisor.parse import parse_answer
from coral.advisor.question import BadAnswer, Usage
from coral.errors import InputError
from coral.exam.asking import Sheet
from coral.exam.item import ExamItem
from coral.file_writer import write_whole
from coral.foreign_file import read_json

SET = "set.json"
"""Index of an inbox: the name of the set, and the question's id for each folder."""


def export(items: Sequence[ExamItem], inbox: Path, about: str) -> int:
    """Export questions into an inbox and return their number.

    Args:
        items: The questions.
        inbox: A new or empty folder.
        about: Name of the set.

    Raises:
        InputError: The folder is not empty, or cannot be written.
    """
    try:
        inbox.mkdir(parents=True, exist_ok=True)
        if any(inbox.iterdir()):
            raise InputError("--export", str(inbox), "a folder that is not empty", "a new or empty folder")
        for number, item in enumerate(items, start=1):
            question_folder(inbox / folder_name(number, item), item.question(), waiting=False)
        places = {folder_name(number, item): item.id for number, item in enumerate(items, start=1)}
        write_whole(inbox / SET, json.dumps({"set": about, "questions": places}, indent=1))
    except OSError as error:
        raise InputError("--export", str(inbox), error.strerror or error, "a folder that can be written") from None
    return len(items)


def answers(items: Sequence[ExamItem], inbox: Path) -> list[Sheet]:
    """Read the answers in an inbox; a question without an answer counts as missing.

    Raises:
        InputError: The folder holds no questions of this set.
    """
    try:
        places = read_json(inbox / SET, "an exported set")["questions"]
    except (InputError, KeyError, TypeError):
        raise InputError("--answers", str(inbox), "no exported set", "a folder that --export wrote") from None
    by_id = {item: inbox / folder for folder, item in places.items()}
    if not any(item.id in by_id for item in items):
        raise InputError("--answers", str(inbox), "questions of another set", "the --sets that it was exported from")
    return [_sheet(item, by_id[item.id]) for item in items if item.id in by_id]


def folder_name(number: int, item: ExamItem) -> str:
    """Name the folder of a question in the same way as the desk does."""
    return f"{number:06d}-{item.kind}"


def _sheet(item: ExamItem, folder: Path) -> Sheet:
    try:
        text = read_answer(folder / "answer.json")
    except OSError:
        return Sheet(item=item, answer=None, failure="missing: nobody answered")
    if text is None:
        return Sheet(item=item, answer=None, failure="not-yours: answer.json is no file of this user")
    try:
        value = parse_answer(text, item.question().answer_type, Usage())
    except BadAnswer as bad:
        return Sheet(item=item, answer=None, raw=text, failure=f"{bad.rejection.code}: {bad.rejection.reason}")
    return Sheet(item=item, answer=value, raw=text)
