"""How much must an advisor be told? First plans of a reader outside for each prompt, followed without repairs.

    python benchmarks/prompts.py export paper --folder desk/paper
    python benchmarks/prompts.py check paper --folder desk/paper
    python benchmarks/prompts.py collect paper --folder desk/paper --answers docs/research/contact-prompt-paper.jsonl
    python benchmarks/prompts.py run paper --answers docs/research/contact-prompt-paper.jsonl --seeds 2000
    python benchmarks/prompts.py run full --seeds 2000

`export` writes the first questions of every trial, a folder for each task: `plan.md` and `regions.md`, as an episode of
that prompt renders them, and their pictures. A reader writes `plan.json` and `regions.json` beside them. Of a task
without a recording it first writes `parameters.md` alone, and the rest when run again beside a `parameters.json`.
`check` has the answers verified as at the beginning of an episode, and leaves `refused.md` where one is refused; the
reader may answer again (`plan-2.json`, `plan-3.json`). `run` follows the answers, one episode each, and prints what
became of them; without `--answers`, the shipped recordings. Masses and frictions are the recorded model's at every
prompt, where there is a recording.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel

from coral.advisor.consult import BudgetCfg
from coral.advisor.parse import parse_answer
from coral.advisor.prompt import render, render_rejections
from coral.advisor.question import Advisor, AdvisorUnavailable, Question, Rejection, Reply, Usage
from coral.advisor.replay import RecordedAdvisor, is_recorded
from coral.campaign.spec import parse_seeds
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.episode import Episode
from coral.contact.episode.resolution import resolve_episode
from coral.contact.episode.variants import AdvisorSetup, make_strategist
from coral.contact.plan.contact_regions import LIMITS
from coral.contact.scene.task_names import HALVES, SUITES, every_task, shipped_tasks, suite_tasks
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task

A = TypeVar("A", bound=BaseModel)
SEED, LATENCY = 2000, "fixed:0.04"
"""Of the trial that the questions show; the world's time that a plan takes."""
VARIANT = "no-refinement"
NAMES = {"physical-parameters": "parameters", "cost-function": "plan", "contact-regions": "regions"}
YOURS = "The one that you have just written to plan.json."


class Reader:
    """Answers a task's questions with what a reader outside wrote; masses and frictions are the recorded model's."""

    name = "reader"
    latency = "recorded"

    def __init__(self, written: Mapping[str, Sequence[str]]) -> None:
        """Keep the answers of a task: texts for each name in `NAMES`, the next one for when one is refused."""
        self._written = written
        self.asked: dict[str, Question[Any]] = {}
        self.refused: dict[str, Sequence[Rejection]] = {}

    async def answer(self, question: Question[A], rejections: Sequence[Rejection]) -> Reply[A]:
        """Give the answer, or after a refusal the next one.

        Raises:
            BadAnswer: The text is no answer.
            AdvisorUnavailable: Nothing (more) was written.
        """
        if question.kind == "physical-parameters" and is_recorded(str(question.facts["task"])):
            return await RecordedAdvisor().answer(question, ())
        name = NAMES[question.kind]
        self.asked[name], self.refused[name] = question, rejections
        texts = self._written.get(name, ())
        if len(rejections) >= len(texts):
            raise AdvisorUnavailable("not-answered", f"no {name}", final=True, latency_s=0.0)
        usage, text = Usage(requests=1), texts[len(rejections)]
        return Reply(value=parse_answer(text, question.answer_type, usage), raw=text, usage=usage, latency_s=0.0)


class Begun:
    """Stops an episode as soon as it has a plan."""

    def tick(self, episode: Any) -> None:
        """Do nothing."""

    def stop_requested(self) -> str:
        """Stop."""
        return "begun"


def main() -> None:
    """Export, check, collect or follow."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("export", "check", "collect", "run"))
    parser.add_argument("prompt", choices=("paper", "words", "full"))
    parser.add_argument("--folder", type=Path, help="of the questions and answers")
    parser.add_argument("--answers", type=Path, help="a line for each task: {task, plan, regions}, lists of texts")
    parser.add_argument("--seeds", default=f"{SEED}")
    parser.add_argument("--only", default="", help="names of tasks, separated by commas")
    said = parser.parse_args()
    only = set(filter(None, said.only.split(",")))
    tasks = [task for task in every_task() if not only or task in only]
    if said.what == "run":
        lines = [] if said.answers is None else map(json.loads, said.answers.read_text(encoding="utf-8").splitlines())
        follow({line["task"]: line for line in lines}, tasks, said)
        return
    for task in tasks:
        folder = said.folder / task
        if said.what == "export":
            export(task, said.prompt, folder)
        elif said.what == "check":
            print(f"{task}: {check(task, said.prompt, folder)}", flush=True)
    if said.what == "collect":
        made = [json.dumps({"task": task, **written_in(said.folder / task)}) for task in tasks]
        said.answers.write_text("".join(f"{line}\n" for line in made), encoding="utf-8")


def export(task: str, prompt: str, folder: Path) -> None:
    """Write the questions of a trial's beginning."""
    reader = Reader({"parameters": written_in(folder)["parameters"]})
    _, strategist = episode_of(task, SEED, prompt, reader)
    folder.mkdir(parents=True, exist_ok=True)
    for name, question in reader.asked.items():
        (folder / f"{name}.md").write_text(question.prompt, encoding="utf-8")
    if "plan" in reader.asked:
        shown = {**strategist._questions.world_prompt(), "plan": YOURS, "limits": LIMITS}
        (folder / "regions.md").write_text(render("contact-regions", shown)[0], encoding="utf-8")
    for picture in reader.asked["plan" if "plan" in reader.asked else "parameters"].pictures:
        (folder / f"{picture.name}.txt").write_text(picture.caption, encoding="utf-8")
        (folder / f"{picture.name}.png").write_bytes(picture.png)


def check(task: str, prompt: str, folder: Path) -> str:
    """Verify a reader's answers; write the reasons of refusals beside them."""
    reader = Reader(written_in(folder))
    result, _ = episode_of(task, SEED, prompt, reader, [Begun()])
    (folder / "refused.md").unlink(missing_ok=True)
    reasons = {name: refused[-1] for name, refused in reader.refused.items() if refused}
    open_ones = {name: one for name, one in reasons.items() if name not in result["decided"]}
    if open_ones:
        text = "\n\n".join(f"# {name}\n{render_rejections(reader.refused[name])}" for name in open_ones)
        (folder / "refused.md").write_text(text, encoding="utf-8")
    missing = [name for name in reader.asked if not written_in(folder)[name]]
    return (
        ", ".join(
            [f"{name} refused: {one.code}" for name, one in open_ones.items()] + [f"no {name}" for name in missing]
        )
        or "accepted"
    )


def written_in(folder: Path) -> dict[str, list[str]]:
    """Read a reader's answers of a task, those after refusals included."""
    endings = ("", *(f"-{number}" for number in range(2, 2 + BudgetCfg().max_requeries)))
    files = {name: [folder / f"{name}{ending}.json" for ending in endings] for name in NAMES.values()}
    return {name: [file.read_text(encoding="utf-8") for file in all_ if file.exists()] for name, all_ in files.items()}


def follow(answers: Mapping[str, Mapping[str, Any]], tasks: Sequence[str], said: argparse.Namespace) -> None:
    """Follow each task's answers in every trial, and print what became of them."""
    print("| task | seed | success | end | time (s) | wall (s) |\n|---|---:|---|---|---:|---:|", flush=True)
    solved: dict[str, int] = {}
    for task in tasks:
        for seed in parse_seeds(said.seeds):
            began = time.monotonic()
            advisor = Reader(answers[task]) if said.answers else RecordedAdvisor()
            result, _ = episode_of(task, seed, said.prompt, advisor)
            solved[task] = solved.get(task, 0) + bool(result["success"])
            end = result["detail"] or result["end_reason"]
            wall_s = time.monotonic() - began
            print(
                f"| {task} | {seed} | {result['success']} | {end} | {result['sim_time_s']:.1f} | {wall_s:.0f} |",
                flush=True,
            )
    trials = len(parse_seeds(said.seeds))
    suites = ((f"{suite}:{half}", suite_tasks(suite, half)) for suite in SUITES for half in HALVES)
    for name, group in (("six", shipped_tasks()), *suites):
        of = [task for task in group if task in solved]
        print(f"{said.prompt}, {name}: {sum(solved[task] for task in of)} of {trials * len(of)}")


def episode_of(
    task: str, seed: int, prompt: Any, advisor: Advisor, observers: Sequence[Any] = ()
) -> tuple[dict[str, Any], Any]:
    """Run an episode of the hand without repairs; return its metrics with what was `decided`, and the strategist."""
    cfg = resolve_episode(EpisodeCfg(), fallback="hold")
    cfg = replace(cfg, planning=replace(cfg.planning, latency=LATENCY))
    cfg = replace(cfg, record=replace(cfg.record, states=False, report=False))
    cfg = resolve_episode(cfg, variant=VARIANT, prompt=prompt)
    with tempfile.TemporaryDirectory() as out:
        given = AdvisorSetup(advisor=advisor.name, given=advisor, seed=seed, think=cfg.think)
        loaded = load_task(task)
        strategist = make_strategist(VARIANT, loaded, given)
        told: set[str] = set()
        episode = Episode(
            sample_trial(loaded, seed),
            "hand",
            strategist,
            cfg,
            Path(out) / "run",
            variant=VARIANT,
            advisor=advisor.name,
        )
        episode.listeners.append(lambda event: told.add(event["decided"]) if event.get("source") == "advisor" else None)
        result = episode.run(observers)
        return {**result, "detail": episode.detail, "decided": told}, strategist


if __name__ == "__main__":
    main()
