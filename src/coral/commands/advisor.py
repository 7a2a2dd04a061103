"""`coral advisor show` and `probe`: text and pictures of a question to a model, and what a model's endpoint can do."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

from coral.advisor.model_cfg import ModelCfg
from coral.advisor.prompt import FOLDER, kinds, render, version
from coral.errors import InputError, RunError, nearest
from coral.exit_code import ExitCode
from coral.file_writer import write_whole, writing
from coral.flags import Argument
from coral.foreign_file import parse_json, read_bytes, read_log_lines, read_text
from coral.limits import PICTURE_BYTES
from coral.odd_text import encodable
from coral.run_files import RunFiles


@dataclass(frozen=True, kw_only=True)
class AdvisorShow:
    """Print the rendered prompt of a kind of question, and write its pictures."""

    kind: Annotated[str, Argument(metavar="KIND")]
    """Kind of question, such as reef-centroid; `list` lists them all."""
    out: Path | None = None
    """Folder for prompt.md and the pictures; without it only the text is printed."""
    world: str = "s1"
    """Reef in which a question of a reef kind comes up."""
    json: bool = False
    """Print one JSON object."""

    def __call__(self) -> Mapping[str, Any]:
        if self.kind == "list":
            return {"kinds": kinds()}
        if self.kind not in kinds():
            expected = f"list, or one of {', '.join(kinds())}{nearest(self.kind, kinds())}"
            raise InputError("KIND", "", repr(self.kind), expected)
        pictures: dict[str, Path] = {}
        with tempfile.TemporaryDirectory() as scratch:
            if self.kind.startswith("reef-"):
                prompt, pictures = _ask_in_mission(self.kind, self.world, Path(scratch) / "run")
            else:
                samples = parse_json(read_text(FOLDER / "samples.json", "a file of this package"))
                prompt = render(self.kind, samples[self.kind])[0]
            written = _write(self.out, prompt, pictures) if self.out else []
        about = {"kind": self.kind, "version": version(self.kind), "prompt": prompt}
        return {**about, "pictures": list(pictures), "written": written}

    def describe(self, result: Mapping[str, Any]) -> str:
        if "kinds" in result:
            return "\n".join(result["kinds"])
        return "\n".join([result["prompt"], *(f"wrote {path}" for path in result["written"])])


def _write(folder: Path, prompt: str, pictures: Mapping[str, Path]) -> list[str]:
    with writing("--out", str(folder), "a folder that can be written"):
        write_whole(folder / "prompt.md", encodable(prompt))
        for name, picture in pictures.items():
            write_whole(folder / f"{name}.png", read_bytes(picture, "a picture", PICTURE_BYTES))
    return [str(folder / "prompt.md"), *(str(folder / f"{name}.png") for name in pictures)]


class _UntilAsked:
    """Stops a mission as soon as a question of one kind has been answered."""

    def __init__(self, log: Path, kind: str) -> None:
        self._log, self._mark = log, f'"kind": "{kind}"'

    def tick(self, mission: Any) -> None:
        """Do nothing."""

    def stop_requested(self) -> str:
        """Stop once the question is in the log."""
        return "asked" if self._mark in "".join(read_log_lines(self._log)) else ""


def _ask_in_mission(kind: str, world: str, folder: Path) -> tuple[str, dict[str, Path]]:
    """Return prompt and pictures of the first question of a kind in a simulated mission."""
    from coral.advisor.rules import RuleAdvisor
    from coral.reef.decide.heuristic import REEF_RULES
    from coral.reef.decide.questions import KINDS, PAPER, WITHOUT_CHAIN
    from coral.reef.mission.mission import Mission
    from coral.reef.mission.mission_cfg import MissionCfg
    from coral.reef.mission.variants import apply_variant
    from coral.reef.pictures.questions import question_pictures
    from coral.reef.world.find_world import find_world

    cfg = MissionCfg(latency="0", stop_when_covered=False)
    if kind == WITHOUT_CHAIN:
        cfg, kind = apply_variant("dream", cfg), KINDS["waypoint"]
    elif kind.endswith(PAPER):
        cfg, kind = apply_variant("paper", cfg), kind.removesuffix(PAPER)
    cfg = replace(cfg, record=replace(cfg.record, frames=False))
    mission = Mission(find_world(world), cfg, RuleAdvisor(REEF_RULES), folder, draw=question_pictures)
    mission.run([_UntilAsked(folder / RunFiles.ATTEMPTS, kind)])
    attempts = [parse_json(line) for line in read_log_lines(folder / RunFiles.ATTEMPTS)]
    asked = [attempt for attempt in attempts if attempt["kind"] == kind]
    if not asked:
        raise RunError(f"no {kind} question comes up in {world}; try another --world")
    names = [name for name, _ in asked[-1]["captions"]]
    return asked[-1]["prompt"], {
        name: folder / RunFiles.PICTURES / f"{digest}.png"
        for name, digest in zip(names, asked[-1]["pictures"], strict=True)
    }


@dataclass(frozen=True, kw_only=True)
class AdvisorProbe:
    """Ask a model a few small questions and report which output modes work and whether it sees pictures."""

    model: Annotated[str, Argument(metavar="MODEL")]
    """The model, as for --advisor: PROVIDER:MODEL or local:URL#MODEL."""
    json: bool = False
    """Print one JSON object."""
    cfg: ModelCfg = field(default_factory=ModelCfg)
    """Time-outs and retries."""

    def __call__(self) -> Mapping[str, Any]:
        from coral.advisor.preflight import probe

        return probe(self.model, self.cfg)

    def describe(self, result: Mapping[str, Any]) -> str:
        asked = {**result["modes"], **({"pictures": result["pictures"]} if result["pictures"] else {})}
        lines = [f"  {name:<9} {one['wall_s']:6.1f} s  {one['says']}" for name, one in asked.items()]
        if not result["recommended"]:
            return "\n".join([result["advisor"], *lines, "  no output mode works"])
        eyes = "" if result["pictures"]["works"] else " --model.no-pictures"
        use = f"--advisor '{result['advisor']}' --model.output {result['recommended']}{eyes}"
        return "\n".join([result["advisor"], *lines, f"  use it with: {use}"])

    def exit_code(self, result: Mapping[str, Any]) -> int:
        """Return a failure if the model cannot be used."""
        return ExitCode.DONE if result["recommended"] else ExitCode.FAILED
