"""Sets of questions as files: a zip of the questions, their keys, and each picture once.

Pictures are stored as lossless WebP, half the size of the PNG that advisors receive, with the same pixels.
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import cv2

from coral.advisor.log import plain_json
from coral.advisor.question import Picture
from coral.errors import InputError, nearest
from coral.exam.item import ANSWERS, ExamItem
from coral.file_writer import scratch_for
from coral.foreign_file import decode_picture, parse_json, read_archive

FORMAT = "coral-questions/1"
SHIPPED = ("public",)
"""Names of the sets in the package."""


@dataclass(frozen=True, kw_only=True)
class QuestionSet:
    """A named set of questions."""

    name: str
    """For tables and reports."""
    about: Mapping[str, Any]
    """Seed and command that made it."""
    items: tuple[ExamItem, ...]
    """The questions."""


def save_set(path: Path, made: QuestionSet) -> None:
    """Write a set; the same set gives the same bytes.

    Raises:
        InputError: The file cannot be written.
    """
    pictures = {picture.digest: picture for item in made.items for picture in item.pictures}
    schemas = {
        kind: ANSWERS[kind].model_json_schema() for kind in ANSWERS if kind in {item.kind for item in made.items}
    }
    head = {"format": FORMAT, "name": made.name, **made.about, "answer_schemas": schemas}
    try:
        with scratch_for(path) as scratch, zipfile.ZipFile(scratch, "w") as folder:
            _put(folder, "set.json", plain_json(head, indent=1).encode())
            _put(folder, "questions.jsonl", _lines(_item_to_json(item) for item in made.items))
            _put(folder, "keys.jsonl", _lines({"id": item.id, **item.key} for item in made.items))
            for digest, picture in sorted(pictures.items()):
                _put(folder, f"pictures/{digest}.webp", _recode(picture.png, ".webp"), zipfile.ZIP_STORED)
    except OSError as error:
        raise InputError(str(path), "--out", error.strerror or error, "a file that can be written") from None


def load_set(name_or_path: str, only: Sequence[str] = (), limit: int | None = None) -> QuestionSet:
    """Load a shipped set by name, or a set from a file.

    Args:
        name_or_path: Name of a shipped set, or path of a file.
        only: Kinds of question to load; all by default.
        limit: At most this many questions of each kind, evenly spread over the set.

    Raises:
        InputError: There is no such set or kind, or the file is not a set.
    """
    path = _path(name_or_path)
    try:
        with read_archive(path) as folder:
            head = parse_json(folder.read("set.json"))
            if head.get("format") != FORMAT:
                raise InputError(str(path), "format", repr(head.get("format")), FORMAT)
            keys = {key.pop("id"): key for key in map(parse_json, folder.read("keys.jsonl").splitlines())}
            shown = [parse_json(line) for line in folder.read("questions.jsonl").splitlines()]
            items = tuple(_item_from_json(entry, keys[entry["id"]], folder) for entry in _select(shown, only, limit))
    except (OSError, zipfile.BadZipFile, KeyError, ValueError) as error:
        raise InputError(
            str(path), "--sets", f"no set of questions ({error})", "a file of `advisor questions`"
        ) from None
    about = {key: value for key, value in head.items() if key not in ("format", "name", "answer_schemas")}
    return QuestionSet(name=head["name"], about=about, items=items)


def _select(shown: Sequence[Mapping[str, Any]], only: Sequence[str], limit: int | None) -> list[Mapping[str, Any]]:
    kinds = list(dict.fromkeys(entry["kind"] for entry in shown))
    for kind in only:
        if kind not in kinds:
            raise InputError("--only", "", repr(kind), f"one of {', '.join(kinds)}{nearest(kind, kinds)}")
    found: list[Mapping[str, Any]] = []
    for kind in kinds:
        of_kind = [entry for entry in shown if entry["kind"] == kind and (not only or kind in only)]
        count = len(of_kind) if limit is None else min(limit, len(of_kind))
        found += [of_kind[k * len(of_kind) // count] for k in range(count)]
    return found


def _path(name: str) -> Path:
    if name in SHIPPED:
        return Path(str(files("coral.exam"))) / "sets" / f"{name}.zip"
    if not Path(name).is_file():
        expected = f"{', '.join(SHIPPED)}, or a file of `coral advisor questions`{nearest(name, SHIPPED)}"
        raise InputError("--sets", "", repr(name), expected)
    return Path(name)


def _item_to_json(item: ExamItem) -> dict[str, Any]:
    return {
        "id": item.id,
        "kind": item.kind,
        "group": item.group,
        "prompt": item.prompt,
        "prompt_version": item.prompt_version,
        "asked_at_s": item.asked_at_s,
        "facts": item.facts,
        "pictures": [
            {"name": p.name, "digest": p.digest, "caption": p.caption, "pixel_from_world": p.pixel_from_world}
            for p in item.pictures
        ],
    }


def _item_from_json(entry: Mapping[str, Any], key: Mapping[str, Any], folder: zipfile.ZipFile) -> ExamItem:
    pictures = tuple(
        Picture(
            name=one["name"],
            png=_recode(folder.read(f"pictures/{one['digest']}.webp"), ".png"),
            caption=one["caption"],
            pixel_from_world=one["pixel_from_world"] and tuple(tuple(row) for row in one["pixel_from_world"]),
        )
        for one in entry["pictures"]
    )
    return ExamItem(**{**entry, "pictures": pictures}, key=key)


def _recode(picture: bytes, form: str) -> bytes:
    """Encode the same pixels in another file format; 101 selects lossless WebP."""
    pixels = decode_picture(picture)
    if pixels is None:
        raise ValueError("a picture cannot be read")
    options = [cv2.IMWRITE_WEBP_QUALITY, 101] if form == ".webp" else [cv2.IMWRITE_PNG_COMPRESSION, 4]
    return bytes(cv2.imencode(form, pixels, options)[1])


def _lines(entries: Any) -> bytes:
    return "".join(plain_json(entry) + "\n" for entry in entries).encode()


def _put(folder: zipfile.ZipFile, name: str, content: bytes, method: int = zipfile.ZIP_DEFLATED) -> None:
    entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
    entry.compress_type = method
    folder.writestr(entry, content, compresslevel=9)
