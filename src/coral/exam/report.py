"""The report of an advisor bench: scores with intervals, scores by kind, cost, and each advisor's worst answers."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import cv2

from coral.exam.result import Result
from coral.foreign_file import decode_picture
from coral.view.page import render_page, write_page

WORST = 8
"""Number of answers shown per advisor."""
WIDE_PX = 420
KINDS: Mapping[str, str] = {
    "reef-centroid": "1 for the dot from which the best tour of what is left ends soonest, on the true map; 0 for one "
    "that loses 10 s, the time of another question, or that the verifiers refuse.",
    "reef-waypoint": "The same for a waypoint. At one reached before the next answer can come, the robot waits.",
    "reef-mission": "Half for a next dot that an oracle would go to, a quarter for what is ruled out, a quarter for "
    "what things are taken for.",
    "physical-parameters": "By the logarithm of the error: 0 from a factor of 4 in mass and of 2 in friction on; mass "
    "counts three quarters.",
    "contact-regions": "Share of the named places on the side of the object that the task wants touched; 0 where the "
    "verifier refuses one: off the surface, or out of reach.",
    "object-poses": "Place within 3 cm (0.6) and, if so, turn within 20° (0.4), modulo the object's symmetry.",
    "parameter-repair": "Share of the error in the belief that is gone; keeping the belief is worth nothing.",
    "cost-function": "1 where the plan succeeds within 12 s in one episode with a free-flying hand, else 0.",
    "cost-repair": "The same, from the state in which a bad plan got stuck.",
    "unified": "Half for the outcome of its plan, a quarter each for its parameters and its places.",
}
"""Definition of the score of each kind, for the report."""


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
        kinds=[(kind, KINDS[kind], rows[0]["by_kind"][kind]["questions"]) for kind in kinds],
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
