"""`coral contact run`: one episode, its run folder and its report."""

from __future__ import annotations

import dataclasses
import os
import select
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal, TextIO

from coral.advisor.attribution import RECORDED_MODEL, who_decided
from coral.advisor.model_cfg import ModelCfg
from coral.advisor.preflight import preflight
from coral.advisor.registry import advisor_help, innermost
from coral.advisor.replay import is_recorded
from coral.commands.around_run import LiveFlags, list_made, render, watching
from coral.commands.config_flag import configured
from coral.commands.progress import EpisodeProgress
from coral.commands.robot_flags import RobotFlags, robot_names
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.episode import Episode
from coral.contact.episode.own_cost import own_cost
from coral.contact.episode.resolution import (
    DEFAULT_ADVISOR,
    DEFAULT_VARIANT,
    assemble_episode,
    check_combination,
    resolve_episode,
)
from coral.contact.episode.trial_log import END_REASONS
from coral.contact.episode.variants import ALONE, REMEMBERING, VARIANTS, AdvisorSetup, contact_advisor, contact_model
from coral.contact.perception.tracker_registry import TRACKERS
from coral.contact.scene.task_names import shipped_tasks
from coral.contact.scene.trial import Trial, sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.think_cfg import StandIn, Told
from coral.contact.thinker.thinking_clock import thinking_latency
from coral.contact.world_model.parameter_estimates import parse_beliefs
from coral.contact.worlds.registry import check_world
from coral.contact.worlds.robot_world import RobotWorld
from coral.errors import InputError, RunError
from coral.flags import Argument, Option, forms_text
from coral.plugins import our_part
from coral.runs import new_run_folder
from coral.terminal import tell
from coral.words import many

TRACKER_HELP = f"Tracker of the objects in those pictures: {forms_text(TRACKERS)}."
VERDICTS: dict[str, Literal["success", "failure"]] = {"s": "success", "f": "failure"}
WAYS_ON = "ask a model (--advisor PROVIDER:MODEL), answer yourself (--advisor desk), or give a cost (--cost FILE)"
"""What to do where nobody recorded an answer."""
HINT = "Judge the episode: s and Enter for success, f and Enter for failure."


@dataclass(frozen=True, kw_only=True)
class ContactRun:
    """Attempt a contact task and write a run folder with logs, metrics, pictures and report."""

    task: Annotated[str, Argument(metavar="TASK", names=shipped_tasks)]
    """A shipped task (see coral contact tasks) or a task file, which also sets the time limit (`time_limit_s`)."""
    arm: Annotated[RobotFlags, Option(name="")] = field(default_factory=RobotFlags)
    advisor: Annotated[str, Option(help=advisor_help("The advisor, in variants with one", rules=False))] = (
        DEFAULT_ADVISOR
    )
    variant: Annotated[str, Option(names=VARIANTS)] = DEFAULT_VARIANT
    """Configuration of the pipeline: full asks the advisor; paper too, with the paper's prompt and 200 samples;
    no-memory, no-refinement, unguided, no-regions and no-tracking disable one part; unified asks one question for
    everything. expert and expert-fsm follow hand-written costs without an advisor."""
    fallback: StandIn | None = None
    """What happens where the advisor does not decide: prior beliefs, no regions and the previous plan are used
    (prior, the default); hold and fail end the episode."""
    prompt: Told | None = None
    """How much a question about a plan tells: only the sentence, poses and parameters (paper), also the scene in words
    (words), also what success is measured by (full, the default)."""
    preflight: bool = True
    """Ask a model one small question first, and refuse the run if it cannot be used."""
    seed: int = 0
    """Seed of all random numbers: poses, masses, frictions, sizes and the planner's noise."""
    cost: Annotated[str | None, Option(metavar="FILE")] = None
    """A cost of your own, instead of a variant: a .py file with `def state_cost(self)`, a YAML or JSON file with
    stages, or an entry point of the group coral.costs. Files are checked and confined like a model's costs."""
    policy: str | None = None
    """[NAME=]ws://HOST:PORT: run a vision-language-action policy on this server instead of planner and variant."""
    poses: Literal["tracked", "ground-truth"] | None = None
    """Source of the objects' poses: tracked, a simulated depth camera's pictures (the default); ground-truth."""
    tracker: Annotated[str | None, Option(help=TRACKER_HELP)] = None
    samples: int | None = None
    """Rollouts per plan, instead of the configuration's."""
    believe: str | None = None
    """Initial beliefs of masses (kg) and frictions, NAME=MASS,FRICTION[;...], instead of the advisor's estimates."""
    memory: str | None = None
    """Experience memory: an SQLite file. It is read at the start, and a success is added to
    it. By default there is none. Only full, no-refinement, no-regions and no-tracking use it."""
    inbox: Path = Path("inbox")
    """Folder for the questions of the advisor `desk`."""
    out: Path | None = None
    """Run folder, new or empty; by default the next free runs/TASK-NNN."""
    config: Path | None = None
    """YAML file with configuration values; flags override it."""
    json: bool = False
    """Print one JSON object on standard output; progress stays on standard error."""
    quiet: bool = False
    """No progress bar."""
    video: bool = False
    """Also write episode.mp4."""
    page: Annotated[LiveFlags, Option(name="")] = field(default_factory=LiveFlags)
    model: ModelCfg = field(default_factory=contact_model)
    """Calls of a real model, and the spending limit of the run."""
    cfg: EpisodeCfg = field(default_factory=EpisodeCfg)
    """Configuration of the episode."""

    @classmethod
    def from_file(cls, words: Sequence[str]) -> ContactRun | None:
        cfg = configured(words, EpisodeCfg())
        return None if cfg is None else cls(task="", cfg=cfg)

    def __call__(self) -> Mapping[str, Any]:
        advisor = contact_advisor(self.advisor, self.model, self.inbox)
        check_combination(
            variant=self.variant,
            advisor=self.advisor,
            seed=self.seed,
            policy=self.policy,
            cost=self.cost,
            believe=self.believe,
            memory=self.memory,
            tracker=self.tracker,
            prompt=self.prompt,
        )
        if not self.arm.check():
            check_world(self.arm.world, also=robot_names())
        self.page.check()
        task = load_task(self.task)
        trial = sample_trial(task, self.seed, self.task)
        cfg = resolve_episode(
            self.cfg,
            variant=self.variant,
            samples=self.samples,
            poses=self.poses,
            tracker=self.tracker,
            fallback=self.fallback,
            prompt=self.prompt,
        )
        thinking_latency(cfg.think.latency, advisor, self.advisor)
        believe = {} if self.believe is None else parse_beliefs(self.believe, task)
        cfg = dataclasses.replace(cfg, record=dataclasses.replace(cfg.record, video=cfg.record.video or self.video))
        world: str | Callable[[], RobotWorld] = self.arm.world
        if self.arm.given:
            robot = self.arm.robot_of()
            trial, cfg = robot.robot_trial(trial, self.arm), robot.robot_cfg(cfg, self.arm)
            world = partial(robot.make_robot_world, trial, cfg, self.arm, self.quiet)
            if self.policy is not None:
                raise InputError("--policy", "", self.policy, "another world: a policy is served in simulation only")
        if self.policy is not None:
            if self.page.live:
                expected = "a planner: a policy has no costs to show"
                raise InputError("--live", "", f"with --policy {self.policy}", expected)
            return self._run_policy(self.policy, trial, cfg)
        cost = None if self.cost is None else own_cost(self.cost, trial, cfg)
        unanswered = cost is None and self._is_unanswered(task.name)
        if unanswered and self.memory is None:
            raise RunError(nobody_answered(task.name, self.variant))
        if cost is None and self.preflight and self.variant not in ALONE:
            preflight(advisor, pictures=True, quiet=self.quiet)
        folder = self.out or new_run_folder(Path("runs"), task.name)
        asking = AdvisorSetup(
            advisor=self.advisor,
            world=self.arm.world,
            memory=self.memory,
            inbox=self.inbox,
            believe=believe,
            model=self.model,
        )
        episode = assemble_episode(
            trial, world, cfg, folder, variant=self.variant, asking=asking, cost=cost, operator=partial(_operator, cfg)
        )
        episode.listeners.append(StandInNotice())
        result = self._attempt(episode, folder, cfg)
        if cost is None and self.variant not in ALONE and innermost(self.advisor)[1] == DEFAULT_ADVISOR:
            if result["end_reason"] == "no-decision: poses":
                raise RunError(nobody_read())
            if result["end_reason"] == "no-strategy" and (unanswered or self.advisor == DEFAULT_ADVISOR):
                raise RunError(nobody_answered(task.name, self.variant))
        return result

    def _is_unanswered(self, task: str) -> bool:
        """Return whether a recording answers, corrupted or not, that has nothing for the task."""
        recorded = innermost(self.advisor)[1] == DEFAULT_ADVISOR and self.variant not in ALONE
        return recorded and not is_recorded(task, self.variant)

    def _attempt(self, episode: Episode, folder: Path, cfg: EpisodeCfg) -> Mapping[str, Any]:
        """Run an episode to its end, and make its pictures and report."""
        with watching(self.page, "contact", episode) as viewers:
            with closing(EpisodeProgress(quiet=self.quiet)) as progress:
                result = episode.run([progress, *viewers])
            policy, recording = cfg.think.fallback, _recorder(episode.advisor)
            decided = who_decided(result, things="decisions", fallback=policy, recording=recording)
            made = render(folder, report=cfg.record.report, video=cfg.record.video)
            return {**result, "decided": decided, "run": str(folder), **made}

    def _run_policy(self, policy: str, trial: Trial, cfg: EpisodeCfg) -> Mapping[str, Any]:
        run = our_part("policy", "served", "--policy")
        with closing(EpisodeProgress(quiet=self.quiet)) as progress:
            result, folder = run(policy, trial, self.arm.world, cfg, self.out, [progress], taken=VARIANTS)
        made = render(folder, report=cfg.record.report, video=cfg.record.video)
        return {**result, "run": str(folder), **made}

    def describe(self, result: Mapping[str, Any]) -> str:
        reason = str(result["end_reason"])
        meaning = END_REASONS.get(reason.partition(":")[0], "")
        unmet = str(result.get("end_detail", "")) if reason == "timeout" else ""
        why = "" if result["success"] else f" ({'; '.join(filter(None, (meaning.rstrip('.'), unmet)))})"
        whole_s = result["time_with_thinking_s"]
        peak = result["peak_hand_force_n"]
        force = "contact forces unknown" if peak is None else f"at most {peak:.0f} N on an object"
        thinking = f" ({whole_s:.1f} s with thinking)" if whole_s > result["sim_time_s"] else ""
        count = many(result["policy_calls"], "answer") if result["policy_calls"] else many(result["plans"], "plan")
        judged = "" if result["judged_by"] == "truth" else f"; judged by {result['judged_by']}"
        how = (
            f" after {result['sim_time_s']:.1f} s simulated{thinking} in {result['wall_time_s']:.0f} s (start and "
            "report not counted); "
            f"{count} of {result['plan_ms_median']:.0f} ms, {result['path_length_m']:.2f} m of path, {force}{judged}"
        )
        outcome = f"{self.task}: {reason}{why}{how if result['steps'] else ' before anything moved'}"
        return "\n".join([outcome, f"run folder: {result['run']}", *list_made(result)])


def _operator(cfg: EpisodeCfg) -> KeyboardVerdict | None:
    """Return the operator where one judges, and tell how."""
    if cfg.judged_by != "operator":
        return None
    tell(HINT)
    return KeyboardVerdict()


def _recorder(advisor: str) -> str:
    """Return what a recording is called in the sentence about who decided."""
    return f"a {RECORDED_MODEL}" if innermost(advisor)[1] == DEFAULT_ADVISOR else "the recording"


def nobody_answered(task: str, variant: str) -> str:
    """Return the line for a task without recorded answers: why there are none, and the ways on."""
    if is_recorded(task, variant):
        return f"no recorded answer for the task {task!r} passes the checks of this trial: {WAYS_ON}"
    if is_recorded(task):
        return (
            f"nobody recorded answers for the task {task!r} with --variant {variant}, which has those of the paper's "
            f"six tasks alone: take one of these, or --variant full, whose answers for {task} are recorded; "
            f"or {WAYS_ON}"
        )
    memory = " and no remembered plan fits" if variant in REMEMBERING else ""
    return f"nobody recorded answers for the task {task!r}{memory}: {WAYS_ON}"


def nobody_read() -> str:
    """Return the line for a picture without recorded poses, where nothing tracks the objects."""
    return (
        "nobody recorded the poses of the objects in this picture, and --variant no-tracking has no others: they are "
        "recorded for the paper's six tasks with --world panda and --seed 1000 to 1009; take one of these, track the "
        f"objects (--variant full), {WAYS_ON}"
    )


class StandInNotice:
    """Reports on standard error, each once, that the advisor did not decide, and why its plans were refused."""

    def __init__(self) -> None:
        self._said = self._told = False

    def __call__(self, event: Mapping[str, Any]) -> None:
        if event["event"] == "plan_answer" and event.get("failure") and event.get("refused") and not self._told:
            self._told = True
            why = "; ".join(dict.fromkeys(event["refused"]))
            tell(f"at {event['t']:.1f} s the advisor gave no usable plan: {why}")
        if event["event"] == "fallback" and not self._said:
            self._said = True
            then = "the episode ends" if event["by"] == "nobody" else f"continuing with {event['by']}"
            tell(
                f"at {event['t']:.1f} s the advisor did not decide on the {event['what']} ({event['because']}): "
                f"{then} (--fallback {event['policy']})"
            )


class KeyboardVerdict:
    """Reads the verdict without waiting for it: a line that is `s` or `f` from a file, by default standard input."""

    def __init__(self, stream: TextIO | None = None) -> None:
        self._file: int | None = (stream or sys.stdin).fileno()
        self._begun = b""

    def __call__(self) -> Literal["success", "failure", ""]:
        """Return the verdict; "" if there is none yet. Other lines get the hint on standard error."""
        # Bytes and not lines are read: a line in the stream's buffer would be invisible to select.
        while self._file is not None and select.select([self._file], [], [], 0)[0]:
            found = os.read(self._file, 4096)
            if not found:  # closed: no verdict will come
                self._file = None
            self._begun += found
        while b"\n" in self._begun:
            line, _, self._begun = self._begun.partition(b"\n")
            word = line.decode(errors="replace").strip().lower()
            if word in VERDICTS:
                return VERDICTS[word]
            tell(HINT)
        return ""
