"""The report of an advisor bench: scores with intervals, scores by kind, cost, and each advisor's worst answers."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import cv2

from coral.exam.result import Result
from coral.exam.score import WORTH
from coral.foreign_file import decode_picture
from coral.view.page import render_page, write_page

WORST = 8
"""Number of answers shown per advisor."""
WIDE_PX = 420


def write_report(path: Path, results: Sequence[Result], rows: Sequence[Mapping[str, Any]], about: str) -> Path:
    """Write the report into the folder of `path` and return the path of its file.

    Raises:
        InputError: The file cannot be written.
    """
    kinds = list(rows[0]["by_kind"])
    ranked = sorted(rows, key=lambda row: -row["score"])
    page = render_page(
        "exam.html.j2",
        about=about,
        questions=rows[0]["questions"],
        rows=ranked,
        kinds=[(kind, WORTH[kind], rows[0]["by_kind"][kind]["questions"]) for kind in kinds],
        headline=_headline(ranked),
        worst=[(result.name, [_answer_row(one) for one in result.worst(WORST)]) for result in results],
    )
    return write_page(path.parent, page)


def _headline(ranked: Sequence[Mapping[str, Any]]) -> str:
    best = ranked[0]
    text = f"{best['name']} scores {best['score']:.2f} ({best['low']:.2f} to {best['high']:.2f})"
    if len(ranked) == 1:
        return f"{text} of 1."
    second = ranked[1]
    apart = "clearly above" if best["low"] > second["high"] else "not clearly above"
    return f"{text} of 1, {apart} {second['name']} with {second['score']:.2f}."


def _answer_row(one: Any) -> dict[str, Any]:
    sheet = one.sheet
    answer = {} if sheet.answer is None else sheet.answer.model_dump(mode="json")
    text = "\n\n".join(stage["code"] for stage in answer.get("stages", ())) or answer.get("code", "")
    rest = {key: value for key, value in answer.items() if key not in ("stages", "code") and value != ""}
    return {
        "id": sheet.item.id,
        "group": sheet.item.group,
        "score": one.worth.score,
        "why": one.worth.why,
        "answer": json.dumps(rest, indent=None, ensure_ascii=False)[:1200] if rest else "",
        "code": text[:2500],
        "faults": ", ".join(sheet.usage.faults),
        "pictures": [(p.name, p.caption, _webp(p.png)) for p in sheet.item.pictures[:2]],
    }


def _webp(png: bytes) -> str:
    """Encode a picture for the report, no wider than its column."""
    pixels = decode_picture(png, cv2.IMREAD_COLOR)
    assert pixels is not None
    scale = min(1.0, WIDE_PX / pixels.shape[1])
    small = cv2.resize(pixels, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    data = cv2.imencode(".webp", small, [cv2.IMWRITE_WEBP_QUALITY, 80])[1]
    return f"data:image/webp;base64,{b64encode(bytes(data)).decode()}"
