"""`coral advisor bench`: is this model good enough?"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from coral.advisor.model_cfg import ModelCfg
from coral.advisor.preflight import preflight
from coral.advisor.question import Advisor
from coral.advisor.registry import advisor_help, make_advisor
from coral.config import checked
from coral.contact.episode.variants import contact_model
from coral.contact.mistakes.plausible import CONTACT_MISTAKES
from coral.errors import InputError
from coral.exam.asking import ask_all
from coral.exam.controls import CONTROLS, control
from coral.exam.grading import Grader
from coral.exam.item import ExamItem
from coral.exam.paper_inbox import answers, export
from coral.exam.question_set import load_set
from coral.exam.report import write_report
from coral.exam.result import Result
from coral.file_writer import write_whole, writing
from coral.flags import Option
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.decide.mistakes import REEF_MISTAKES

HELP = advisor_help("Advisors, separated by commas; also the controls random and constant, which know nothing")


@dataclass(frozen=True, kw_only=True)
class AdvisorBench:
    """Ask advisors frozen questions with scored answers, each question once, without a mission or an episode."""

    advisors: Annotated[str, Option(help=HELP)] = "random,heuristic"
    sets: str = "public"
    """Sets of questions, separated by commas: public, or files of `coral advisor questions`."""
    only: str = ""
    """Kinds of question, separated by commas; all by default."""
    limit: int | None = None
    """At most this many questions of each kind."""
    out: Path | None = None
    """Folder for report.html, results.json and answers.jsonl."""
    export: Path | None = None
    """Ask no advisor: export the questions as a desk inbox into this folder."""
    answers: Path | None = None
    """Ask no advisor: score the answers in this inbox, which --export wrote."""
    name: str = "inbox"
    """Name of the answers' author."""
    seed: int = 0
    """Seed of advisors with random answers or errors."""
    at_once: int = 1
    """Number of simultaneous questions to a model."""
    jobs: int = 1
    """Number of processes for the episodes that score plans."""
    preflight: bool = True
    """Ask each model one small question first, and refuse to begin if it cannot be used."""
    model: ModelCfg = field(default_factory=contact_model)
    """Calls of a real model, and the spending limit."""
    quiet: bool = False
    """No progress on standard error."""
    json: bool = False
    """Print one JSON object."""

    def __call__(self) -> Mapping[str, Any]:
        """Ask and score."""
        for flag, value in (
            ("--at-once", self.at_once),
            ("--jobs", self.jobs),
            ("--limit", 1 if self.limit is None else self.limit),
        ):
            if value < 1:
                raise InputError(flag, "", value, "a number of 1 or more")
        asking = self.export is None and self.answers is None
        made = {name: self._advisor(name) for name in self._names()} if asking else {}
        items, about = self._items()
        if self.export is not None:
            return {"exported": export(items, self.export, about), "inbox": str(self.export)}
        if self.out is not None and self.out.exists() and any(self.out.iterdir()):
            raise InputError("--out", str(self.out), "a folder that is not empty", "a new or empty folder")
        grader = Grader(self.jobs)
        if self.answers is not None:
            results = [Result(name=self.name, graded=tuple(grader.grade(answers(items, self.answers))))]
        else:
            results = self._ask(made, items, grader)
        rows = [result.row() for result in results]
        written = {} if self.out is None else self._write(results, rows, about)
        return {"sets": about, "questions": len(items), "rows": rows, **written}

    def _items(self) -> tuple[list[ExamItem], str]:
        only = tuple(kind.strip() for kind in self.only.split(",") if kind.strip())
        sets = [load_set(name.strip(), only, self.limit) for name in self.sets.split(",")]
        if len({one.name for one in sets}) < len(sets):
            raise InputError("--sets", "", repr(self.sets), "each set once")
        return [item for one in sets for item in one.items], ",".join(one.name for one in sets)

    def _names(self) -> list[str]:
        names = [name.strip() for name in self.advisors.split(",") if name.strip()]
        if not names or len(set(names)) < len(names):
            raise InputError("--advisors", "", repr(self.advisors), "one advisor or more, each once")
        return names

    def _ask(self, made: Mapping[str, Advisor], items: list[ExamItem], grader: Grader) -> list[Result]:
        for advisor in made.values() if self.preflight else ():
            preflight(advisor, pictures=any(i.pictures for i in items), where="--advisors", quiet=self.quiet)
        results = []
        for name, advisor in made.items():
            sheets = ask_all(advisor, items, self.at_once)
            if not self.quiet:
                print(f"{name}: {len(sheets)} questions asked", file=sys.stderr, flush=True)
            results.append(Result(name=name, graded=tuple(grader.grade(sheets))))
        return results

    def _advisor(self, name: str) -> Advisor:
        rng = np.random.default_rng([self.seed, 7])
        if name in CONTROLS:
            return control(name, rng)
        return make_advisor(
            name,
            rules=REEF_RULES,
            rng=rng,
            inbox=None if self.out is None else self.out / "inbox",
            cfg=checked(self.model, "--model"),
            where="--advisors",
            mistakes=(*REEF_MISTAKES, *CONTACT_MISTAKES),
        )

    def _write(self, results: list[Result], rows: list[dict[str, Any]], about: str) -> dict[str, str]:
        folder = self.out
        assert folder is not None
        with writing("--out", str(folder), "a folder that can be written"):
            write_whole(folder / "results.json", json.dumps({"sets": about, "rows": rows}, indent=1))
            lines = (json.dumps(_line(result.name, one)) + "\n" for result in results for one in result.graded)
            write_whole(folder / "answers.jsonl", "".join(lines))
        return {"report": str(write_report(folder / "report.html", results, rows, about))}

    def describe(self, result: Mapping[str, Any]) -> str:
        """Return a line for each advisor, the best kind of answer last."""
        if "exported" in result:
            return f"{result['exported']} questions are in {result['inbox']}; `coral desk {result['inbox']}` shows them"
        kinds = list(result["rows"][0]["by_kind"])
        width = max(len("advisor"), *(len(row["name"]) for row in result["rows"]))
        lines = [f"{'advisor':<{width}}  score   95 % interval   " + "  ".join(kinds)]
        for row in result["rows"]:
            each = "  ".join(f"{row['by_kind'][kind]['score']:>{len(kind)}.2f}" for kind in kinds)
            lines.append(
                f"{row['name']:<{width}}   {row['score']:.2f}   {row['low']:.2f} to {row['high']:.2f}    {each}"
            )
        return "\n".join([*lines, *([f"report: {result['report']}"] if "report" in result else [])])


def _line(name: str, one: Any) -> dict[str, Any]:
    sheet = one.sheet
    return {
        "advisor": name,
        "id": sheet.item.id,
        "kind": sheet.item.kind,
        "score": round(one.worth.score, 4),
        "why": one.worth.why,
        "answer": None if sheet.answer is None else sheet.answer.model_dump(mode="json"),
        "raw": sheet.raw[:20_000],
        "seconds": sheet.seconds,
        "faults": list(sheet.usage.faults),
    }
