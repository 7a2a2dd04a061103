"""`coral.run_mission`: one reef mission as a function call."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from coral.advisor.fallback import Fallback
from coral.advisor.model_cfg import ModelCfg
from coral.advisor.preflight import preflight as ask_first
from coral.advisor.question import Advisor
from coral.advisor.registry import asks_person, check_advisor, rules_alone
from coral.config import resolve_settings
from coral.interface.result import ResultFolder, RunResult, demand_inbox
from coral.plugins import our_part
from coral.reef.decide.own_parts import Check, Wanted
from coral.reef.drive.controllers import MakeController
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.resolution import reef_advisor, resolve_mission
from coral.reef.pictures.questions import question_pictures
from coral.reef.world.find_world import find_world
from coral.reef.world.world import ReefWorld
from coral.run_files import RunFiles
from coral.run_loop import Observer


class MissionResult(RunResult):
    """Result of a reef mission."""

    _system = "reef"
    _shown = ("end_reason", "coverage", "collisions", "advisor_calls", "sim_time_s")

    @property
    def coverage(self) -> float:
        """Return the share of the clusters that were covered, 0 to 1."""
        return float(self.metrics["coverage"])


def run_mission(
    world: str | Path | ReefWorld,
    *,
    advisor: str | Advisor = "heuristic",
    controller: str | MakeController | None = None,
    trigger: str | Wanted | None = None,
    verifier: str | Check | None = None,
    variant: str = "full",
    preset: str = "clear",
    fallback: Fallback | None = None,
    seed: int = 0,
    cfg: MissionCfg | Mapping[str, Any] | str | Path | None = None,
    model: ModelCfg | None = None,
    out: str | Path | None = None,
    report: bool | None = None,
    video: bool = False,
    preflight: bool = True,
    observers: Sequence[Observer[Mission]] = (),
) -> MissionResult:
    """Survey a reef; the same arguments give the same mission as `coral reef run`.

    It also works where an event loop is running, as in a notebook.

    Args:
        world: A shipped or generated reef by name, a world file, or a `ReefWorld`.
        advisor: Who decides: as on the command line, or an object with a `name` and a coroutine `answer`.
        controller: "ddp-mppi", "pd", an entry point of the group `coral.controllers`, or a function of a
            `ControllerSetup` that makes a controller.
        trigger: When the advisor is asked: a function of a `TriggerMoment` that returns whether to ask, or an entry
            point of the group `coral.triggers`.
        verifier: A function of question and answer that returns why an answer is refused, or None; it comes after our
            own checks. Or an entry point of the group `coral.verifiers`.
        variant: Configuration of the pipeline.
        preset: Water and sensors.
        fallback: What happens where the advisor does not decide; None as configured.
        seed: Seed of all random numbers.
        cfg: A `MissionCfg`, a mapping such as `{"time_limit_s": 60}` or `{"pilot.trigger.distance_m": 3}`, or a file.
        model: Calls of a real model.
        out: Run folder, new or empty; None for a temporary one, which disappears with the result.
        report: Whether to write map.png and report.html; None: if `out` is given.
        video: Whether to write mission.mp4.
        preflight: Whether to ask a model one small question first.
        observers: Watch the mission after every control tick.

    Raises:
        InputError: An argument is wrong; the text is the one that the command line prints.
    """
    found = world if isinstance(world, ReefWorld) else find_world(world)
    given, keep = resolve_settings(cfg, MissionCfg())
    named = advisor if isinstance(advisor, str) else ""
    asks_people = asks_person(named)
    demand_inbox(named, out)
    resolved, found = resolve_mission(
        given, found, variant=variant, preset=preset, fallback=fallback, keep=keep, asks_people=asks_people
    )
    folder = ResultFolder(out)
    kept = out is not None or video
    record = dataclasses.replace(
        resolved.record,
        report=resolved.record.report and out is not None if report is None else report,
        video=resolved.record.video or video,
        frames=resolved.record.frames and (kept or bool(report)),
        pictures=resolved.record.pictures and (kept or bool(report) or not rules_alone(named)),
    )
    resolved = dataclasses.replace(resolved, record=record)
    of_errors = int(seed) if isinstance(seed, int) and seed >= 0 else 0
    who: Advisor = (
        reef_advisor(advisor, of_errors, inbox=folder.path / RunFiles.INBOX, model=model)
        if isinstance(advisor, str)
        else check_advisor(advisor)
    )
    if preflight and resolved.decider == "advisor":
        ask_first(who, pictures=record.pictures, quiet=True)
    mission = Mission(
        found,
        resolved,
        who,
        folder.path,
        seed=seed,
        variant=variant,
        preset=preset,
        draw=question_pictures if record.pictures else None,
        controller=controller,
        trigger=trigger,
        verifier=verifier,
    )
    result = mission.run(observers)
    if record.report or record.video:
        our_part("rendering", "run", "report")(folder.path, report=record.report, video=record.video)
    return MissionResult(folder, result)
