"""Grading of sheets: plans by one episode each, in worker processes; everything else in this process."""

from __future__ import annotations

import json
import multiprocessing
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

from coral.exam.asking import Sheet
from coral.exam.item import ANSWERS, ExamItem
from coral.exam.score import score
from coral.exam.worth import Worth

EPISODES = ("cost-function", "cost-repair", "unified")
"""Kinds of question whose answers are scored by an episode."""


@dataclass(frozen=True)
class Graded:
    """A sheet with its score."""

    sheet: Sheet
    worth: Worth


class Grader:
    """Grades sheets; equal answers to a question are followed in an episode only once.

    Args:
        jobs: Number of processes for episodes.
    """

    def __init__(self, jobs: int = 1) -> None:
        self._jobs = jobs
        self._known: dict[tuple[str, str], Worth] = {}

    def grade(self, sheets: Sequence[Sheet]) -> list[Graded]:
        """Score every sheet; one without an answer scores 0."""
        texts = {id(sheet): _text(sheet) for sheet in sheets if sheet.answer is not None}
        wanted = {
            (sheet.item.id, texts[id(sheet)]): sheet.item
            for sheet in sheets
            if sheet.answer is not None and sheet.item.kind in EPISODES
        }
        self._follow({key: item for key, item in wanted.items() if key not in self._known})
        return [Graded(sheet, self._worth(sheet, texts.get(id(sheet), ""))) for sheet in sheets]

    def _worth(self, sheet: Sheet, text: str) -> Worth:
        if sheet.answer is None:
            return Worth(0.0, sheet.failure)
        return self._known.get((sheet.item.id, text)) or score(sheet.item, sheet.answer)

    def _follow(self, wanted: dict[tuple[str, str], ExamItem]) -> None:
        work = [(item.kind, dict(item.key), dict(item.facts), text) for (_, text), item in wanted.items()]
        if self._jobs == 1 or len(work) < 2:
            for key, one in zip(wanted, work, strict=True):
                self._known[key] = outcome(*one)
            return
        spawn = multiprocessing.get_context("spawn")
        with ProcessPoolExecutor(min(self._jobs, len(work)), mp_context=spawn) as pool:
            self._known |= zip(wanted, pool.map(outcome, *zip(*work, strict=True)), strict=True)


def outcome(kind: str, key: dict[str, object], facts: dict[str, object], text: str) -> Worth:
    """Score an answer given as JSON text; runs in a process of its own."""
    item = ExamItem(id="", kind=kind, group="", prompt="", prompt_version="", facts=facts, key=key)
    return score(item, ANSWERS[kind].model_validate_json(text))


def _text(sheet: Sheet) -> str:
    assert sheet.answer is not None
    return json.dumps(sheet.answer.model_dump(mode="json"), sort_keys=True)
