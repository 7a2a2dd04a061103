"""`coral.run_task`: one contact task as a function call."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from coral.advisor.model_cfg import ModelCfg
from coral.advisor.preflight import preflight as ask_first
from coral.advisor.question import Advisor
from coral.advisor.registry import check_advisor
from coral.config import resolve_settings
from coral.contact.control.hand_controllers import MakeHandController
from coral.contact.cost.context import Context
from coral.contact.cost.stages import CostFunction, Stage, Strategy
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
from coral.contact.episode.variants import ALONE, AdvisorSetup, contact_advisor, contact_model
from coral.contact.scene.condition import BaseCondition
from coral.contact.scene.task import Task
from coral.contact.scene.task_validation import check_task
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.think_cfg import StandIn
from coral.contact.thinker.thinking_clock import thinking_latency
from coral.contact.world_model.parameter_estimates import parse_beliefs
from coral.contact.worlds.registry import check_world
from coral.errors import InputError
from coral.interface.result import ResultFolder, RunResult, demand_inbox
from coral.plugins import our_part
from coral.run_files import RunFiles
from coral.run_loop import Observer

__all__ = ["Context", "TaskResult", "run_task"]


class TaskResult(RunResult):
    """Result of a contact task."""

    _system = "contact"
    _shown = ("end_reason", "success", "sim_time_s", "plans", "advisor_calls", "path_length_m")

    @property
    def success(self) -> bool:
        """Return whether the task was done, judged by the true state."""
        return bool(self.metrics["success"])


def run_task(
    task: str | Path | Task,
    *,
    cost: str | Path | CostFunction | Stage | Sequence[Stage] | Strategy | None = None,
    advisor: str | Advisor | None = None,
    controller: str | MakeHandController = "mppi",
    variant: str | None = None,
    world: str = "panda",
    conditions: Sequence[BaseCondition] | None = None,
    seed: int = 0,
    samples: int | None = None,
    poses: Literal["tracked", "ground-truth"] | None = None,
    tracker: str | None = None,
    believe: str | None = None,
    memory: str | Path | None = None,
    fallback: StandIn | None = None,
    cfg: EpisodeCfg | Mapping[str, Any] | str | Path | None = None,
    model: ModelCfg | None = None,
    out: str | Path | None = None,
    report: bool | None = None,
    video: bool = False,
    preflight: bool = True,
    observers: Sequence[Observer[Episode]] = (),
) -> TaskResult:
    """Attempt a contact task; the same arguments give the same episode as `coral contact run`.

    It also works where an event loop is running, as in a notebook.

    Args:
        task: A shipped task by name, a task file, or a `Task`.
        cost: A cost of your own, which the planner follows: a function of a `Context` (NumPy), a `Stage`, several
            stages, a `Strategy`, a file with a program, or an entry point of the group `coral.costs`. Your own cost
            uses the middle of the task file's ranges as masses and frictions.
        advisor: Who decides: as on the command line, or an object with a `name` and a coroutine `answer`.
        controller: "mppi", an entry point of the group `coral.hand_controllers`, or a function of planning world,
            configuration and generator that makes a controller.
        variant: Configuration of the pipeline; None: "full".
        world: Evaluation world: "panda", which needs robosuite, or "hand".
        conditions: Conditions of success in place of the task's own; any subclass of `BaseCondition`.
        seed: Seed of all random numbers.
        samples: Rollouts per plan; None as configured.
        poses: Source of the objects' poses; None as configured.
        tracker: The tracker.
        believe: Initial masses and frictions, NAME=MASS,FRICTION[;...], instead of the advisor's estimates.
        memory: The experience memory.
        fallback: What happens where the advisor does not decide; None as configured.
        cfg: An `EpisodeCfg`, a mapping such as `{"controller.horizon": 20}`, or a YAML file.
        model: Calls of a real model.
        out: Run folder, new or empty; None for a temporary one, which disappears with the result.
        report: Whether to write report.html and keyframes.png; None: if `out` is given.
        video: Whether to write episode.mp4.
        preflight: Whether to ask a model one small question first.
        observers: Watch the episode after every plan.

    Raises:
        InputError: An argument is wrong; the text is the one that the command line prints.
        RunError: The Panda is asked for and robosuite is not installed.
    """
    folder = ResultFolder(out)
    own_advisor = None if advisor is None or isinstance(advisor, str) else check_advisor(advisor)
    named = advisor if isinstance(advisor, str) else ""
    spec = own_advisor.name if own_advisor is not None else named or DEFAULT_ADVISOR
    demand_inbox(named, out)
    chosen = variant or DEFAULT_VARIANT
    who = own_advisor or contact_advisor(spec, model or contact_model(), folder.path / RunFiles.INBOX)
    if cost is not None and advisor is not None:
        raise InputError("--cost", "", f"also --advisor {spec}", "one of the two: a cost of your own asks nobody")
    check_combination(
        variant=chosen,
        advisor=spec,
        seed=seed,
        cost=None if cost is None else "own",
        believe=believe,
        memory=None if memory is None else str(memory),
        tracker=tracker,
    )
    check_world(world)
    found = task if isinstance(task, Task) else load_task(task)
    if isinstance(task, Task):
        check_task(task, "task")
    if conditions is not None:
        found = with_conditions(found, conditions)
    trial = sample_trial(found, seed, str(task) if not isinstance(task, Task) else "")
    settings, _ = resolve_settings(cfg, EpisodeCfg())
    settings = resolve_episode(
        settings, variant=chosen, samples=samples, poses=poses, tracker=tracker, fallback=fallback
    )
    thinking_latency(settings.think.latency, who, spec)
    beliefs = {} if believe is None else parse_beliefs(believe, found)
    record = dataclasses.replace(
        settings.record,
        report=settings.record.report and out is not None if report is None else report,
        video=settings.record.video or video,
    )
    settings = dataclasses.replace(settings, record=record)
    own = None if cost is None else own_cost(cost, trial, settings, "cost")
    if own is None and preflight and chosen not in ALONE:
        ask_first(who, pictures=True, quiet=True)
    asking = AdvisorSetup(
        advisor=spec,
        given=own_advisor,
        world=world,
        memory=memory,
        inbox=folder.path / RunFiles.INBOX,
        believe=beliefs,
        model=model or contact_model(),
    )
    episode = assemble_episode(
        trial, world, settings, folder.path, variant=chosen, asking=asking, cost=own, controller=controller
    )
    result = episode.run(observers)
    if record.report or record.video:
        our_part("rendering", "run", "report")(folder.path, report=record.report, video=record.video)
    return TaskResult(folder, result)


def with_conditions(task: Task, conditions: Sequence[BaseCondition]) -> Task:
    """Replace a task's conditions of success.

    Raises:
        InputError: There are none, one is no condition, or one names an object that the task does not have.
    """
    if not conditions or not all(isinstance(condition, BaseCondition) for condition in conditions):
        raise InputError("conditions", "", repr(conditions), "one or more conditions, such as Lifted(...)")
    success = task.success.model_copy(update={"conditions": tuple(conditions)})
    changed = task.model_copy(update={"success": success})
    check_task(changed, "conditions")
    return changed
