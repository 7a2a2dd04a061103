"""`coral reef run`: one mission, its run folder and its report."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

from coral.advisor.attribution import who_decided
from coral.advisor.fallback import Fallback
from coral.advisor.model_cfg import ModelCfg
from coral.advisor.preflight import preflight
from coral.advisor.registry import advisor_help, asks_person
from coral.commands.around_run import LiveFlags, list_made, mission_notice, render, watching
from coral.commands.config_flag import configured, given_keys, set_keys
from coral.commands.progress import MissionProgress
from coral.errors import InputError
from coral.flags import Argument, Option
from coral.reef.drive.controller_kernels import rollout
from coral.reef.mission.metrics import OWN_MAP
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.presets import CLEAR, PRESETS, preset_help
from coral.reef.mission.resolution import reef_advisor, resolve_mission, with_sonar
from coral.reef.mission.variants import VARIANTS
from coral.reef.mission.word_judge import with_instruction
from coral.reef.pictures.questions import question_pictures
from coral.reef.world.find_world import find_world
from coral.reef.world.world_names import shipped_worlds
from coral.run_files import RunFiles
from coral.runs import new_run_folder
from coral.terminal import tell
from coral.words import many

NOTICE = "compiling once, about a minute"


@dataclass(frozen=True, kw_only=True)
class ReefRun:
    """Survey a reef with CORAL and write a run folder with logs, metrics, map and report."""

    world: Annotated[str, Argument(metavar="WORLD", names=shipped_worlds)]
    """A shipped reef (l1 l2 s1 s2 k1 k2 e1 e2 o1 o2), a generated one (gen:0 to gen:39) or a world file."""
    advisor: Annotated[str, Option(help=advisor_help("Who decides"))] = "heuristic"
    variant: Annotated[str, Option(names=VARIANTS)] = "full"
    """Configuration of the pipeline: full, or an ablation or baseline."""
    preset: Annotated[str, Option(help=preset_help("Water and sensors"), names=PRESETS)] = CLEAR
    instruction: Annotated[str | None, Option(metavar="TEXT")] = None
    """What to do, in plain words, in place of the words of the world's mission (words:FAMILY:N has one)."""
    fallback: Fallback | None = None
    """Fallback when the advisor does not decide: rules (the default, reported at the end), hold (keep the goal, ask
    again), fail (end the mission)."""
    preflight: bool = True
    """Ask a model one small question first, and refuse the run if it cannot be used."""
    sonar: bool = False
    """Give the vehicle an imaging sonar, a simulated Sonar 3D-15, whose obstacles go onto the map."""
    perception: Annotated[str | None, Option(metavar="exact|painted|FILE.onnx")] = None
    """Where classes and depth come from: the ray caster (exact, the default), the network that comes with CORAL for
    painted pictures, or one of yours, both on colour pictures alone."""
    depth: Annotated[Path | None, Option(metavar="FILE.onnx")] = None
    """A relative depth network (Depth Anything V2) whose depth replaces that of --perception, which still gives the
    classes."""
    seed: int = 0
    """Seed of all random numbers."""
    out: Path | None = None
    """Run folder, new or empty; by default the next free runs/WORLD-NNN."""
    trigger: str | None = None
    """Entry point of the group coral.triggers that decides when the advisor is asked, instead of the smart trigger."""
    verifier: str | None = None
    """Entry point of the group coral.verifiers that checks answers after our own checks."""
    config: Path | None = None
    """YAML file with configuration values; flags override it."""
    inbox: Path | None = None
    """Folder for the questions of `--advisor desk`; by default inbox/ in the run folder."""
    json: bool = False
    """Print one JSON object on standard output; progress stays on standard error."""
    quiet: bool = False
    """No progress bar."""
    video: bool = False
    """Also write mission.mp4."""
    page: Annotated[LiveFlags, Option(name="")] = field(default_factory=lambda: LiveFlags(live_speed=5.0))
    model: ModelCfg = field(default_factory=ModelCfg)
    """Calls of a real model, and the spending limit of the run."""
    cfg: MissionCfg = field(default_factory=MissionCfg)
    """The mission."""
    given: Annotated[tuple[str, ...], Option(hidden=True)] = ()
    """Keys of the mission that flags or the file set: they win over the preset."""

    @classmethod
    def from_file(cls, words: Sequence[str]) -> ReefRun | None:
        cfg, given = configured(words, MissionCfg()), given_keys(words)
        return cls(world="", cfg=cfg or MissionCfg(), given=given) if given or cfg is not None else None

    def __call__(self) -> Mapping[str, Any]:
        self.page.check()
        world = find_world(self.world)
        if self.seed < 0:
            raise InputError("--seed", "", self.seed, "a number of 0 or more")
        asks_people = asks_person(self.advisor)
        cfg, world = resolve_mission(
            dataclasses.replace(
                with_sonar(self.cfg) if self.sonar else self.cfg,
                perception=self.cfg.perception if self.perception is None else self.perception,
                depth=self.cfg.depth if self.depth is None else str(self.depth),
            ),
            world,
            variant=self.variant,
            preset=self.preset,
            fallback=self.fallback,
            keep=set_keys(self.cfg, MissionCfg(), self.given),
            asks_people=asks_people,
        )
        cfg = dataclasses.replace(cfg, record=dataclasses.replace(cfg.record, video=cfg.record.video or self.video))
        if self.page.live:
            cfg = dataclasses.replace(cfg, controller=dataclasses.replace(cfg.controller, keep_rollouts=True))
        if self.instruction is not None:
            cfg = with_instruction(cfg, self.instruction, world.mission)
        folder = self.out or new_run_folder(Path("runs"), world.name)
        inbox = self.inbox or folder / RunFiles.INBOX
        advisor = reef_advisor(self.advisor, self.seed, inbox=inbox, model=self.model)
        if self.preflight and cfg.decider == "advisor":
            preflight(advisor, pictures=cfg.record.pictures, quiet=self.quiet)
        mission = Mission(
            world,
            cfg,
            advisor,
            folder,
            seed=self.seed,
            variant=self.variant,
            preset=self.preset,
            draw=question_pictures if cfg.record.pictures else None,
            trigger=self.trigger,
            verifier=self.verifier,
            begins=self._tell_compiling,
        )
        if mission.eyes is not None and not self.quiet:
            for line in mission.eyes.about:
                tell(line)
        progress = MissionProgress(quiet=self.quiet)
        mission.listeners.append(FallbackNotice(cfg.pilot.fallback))
        about = {"world": world.name, "variant": self.variant, "seed": self.seed, "run": str(folder)}
        about["instruction"] = mission.cfg.planner.instruction.text
        if asks_people and not self.quiet:
            tell(f"to answer its questions in a browser: coral desk {inbox}")
        with watching(self.page, "reef", mission) as viewers:
            with closing(progress), mission_notice(asks_people, inbox, mission.instructing, **about) as notice:
                if notice is not None:
                    mission.listeners.append(notice.hear)
                result = mission.run([progress, *viewers])
                if notice is not None:
                    notice.finished(
                        f"{result['clusters_covered']} of {result['clusters_total']} oyster clusters covered, "
                        f"{many(result['collisions'], 'collision')}, {result['sim_time_s']:.0f} s simulated; "
                        f"{result['end_reason']}"
                    )
            decided = who_decided(result, things="goals", fallback=cfg.pilot.fallback)
            made = render(folder, report=cfg.record.report, video=cfg.record.video)
            return {**result, "decided": decided, "run": str(folder), **made}

    def _tell_compiling(self) -> None:
        if not self.quiet and not is_compiled():
            tell(NOTICE)

    def describe(self, result: Mapping[str, Any]) -> str:
        lines = [
            f"{self.world}: {covered(result)}{many(result['collisions'], 'collision')}, "
            f"{many(result['advisor_calls'], 'advisor call')} ({many(result['requeries'], 're-query', 're-queries')}), "
            f"{result['sim_time_s']:.0f} s simulated in "
            f"{result['wall_time_s']:.0f} s (compiling counted, start and report not); ended: {result['end_reason']}",
            *fulfilled(result),
            *([] if "success" in result else still_left(result)),
            f"run folder: {result['run']}",
            *list_made(result),
        ]
        return "\n".join(lines)


def covered(result: Mapping[str, Any]) -> str:
    """Say how many clusters were covered; nothing where a mission in words has a reef without oysters."""
    if "success" in result and not result["clusters_total"]:
        return ""
    share = f"({100 * result['coverage']:.0f} %), {share_inspected(result)}"
    return f"{result['clusters_covered']} of {result['clusters_total']} oyster clusters covered {share}"


def share_inspected(result: Mapping[str, Any]) -> str:
    """Say how much was seen from near enough to count oysters, which is less than what counts as covered."""
    share = result.get("inspected")
    return "" if share is None else f"{100 * share:.0f} % of the oysters inspected from near, "


def fulfilled(result: Mapping[str, Any]) -> list[str]:
    """Return the verdict on a mission in words, and what the advisor answered; nothing for other missions."""
    if "success" not in result:
        return []
    answer = f"; answer: {result['answer'] or 'none'}"
    if result["success"] is None:
        at_sea = result.get("judged_by") == OWN_MAP
        return [f"mission not judged: {'nobody judges at sea' if at_sea else 'words without known conditions'}{answer}"]
    missed = [f"{one['condition']} ({one['found']})" for one in result["conditions"] if not one["met"]]
    missed += ["contact"] if result["collisions"] else []
    verdict = "mission fulfilled" if result["success"] else f"mission not fulfilled: {', '.join(missed)}"
    return [f"{verdict}{answer}"]


def still_left(result: Mapping[str, Any]) -> list[str]:
    """Return a line about what the robot knew of and did not finish, and one about the time it did not survey."""
    left, states = result.get("clusters_left"), result.get("seconds_in_state") or {}
    stood = [f"{state} {states[state]:.0f} s" for state in ("holding", "surfacing", "taken over") if state in states]
    lines = [f"not fully inspected, by the robot's own map: {many(left, 'cluster')}"] if left else []
    return [*lines, *([f"not surveying: {', '.join(stood)}"] if stood else [])]


class FallbackNotice:
    """Reports once on standard error that the advisor did not decide."""

    def __init__(self, policy: Fallback) -> None:
        self._policy, self._said, self._refused = policy, False, ""

    def __call__(self, event: Mapping[str, Any]) -> None:
        if event["event"] == "verdict" and event["verdict"] in ("rejected", "malformed"):
            self._refused = f", the last answer because: {event['reason'] or event['code']}"
        if event["event"] == "fallback" and not self._said:
            self._said = True
            then = {"rules": "the fallback's rules decide", "hold": "the goal is kept", "fail": "the mission ends"}
            refused = event["failure"] == "requeries-used-up"
            why = f"every answer was refused{self._refused}" if refused else str(event["failure"])
            tell(
                f"at {event['t']:.0f} s the advisor did not decide ({why}): {then[self._policy]} "
                f"(--fallback {self._policy})"
            )


def is_compiled(kernel: Any = rollout) -> bool:
    """Check whether numba's cache has a kernel, by default the one that takes longest, of the present source.

    True also where nobody can tell, as with numba's compiler switched off.
    """
    cache = getattr(getattr(kernel, "_cache", None), "cache_path", None)
    if cache is None:
        return True
    code = kernel.py_func.__code__
    source = Path(code.co_filename)
    index = sorted(Path(cache).glob(f"{source.stem}.{code.co_name}-{code.co_firstlineno}.*.nbi"))
    return any(one.stat().st_mtime >= source.stat().st_mtime for one in index)
