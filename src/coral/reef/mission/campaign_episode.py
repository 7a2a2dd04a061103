"""One mission of a campaign. It keeps few files and returns everything that the tables need."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

from coral.advisor.model_cfg import ModelCfg
from coral.advisor.registry import asks_person
from coral.errors import RunError
from coral.reef.decide.planner import Draw
from coral.reef.mission.metrics import covered_at
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.mission.resolution import reef_advisor, with_deadline
from coral.reef.world.world import ReefWorld


def run_episode(
    world: ReefWorld,
    cfg: MissionCfg,
    folder: Path,
    *,
    variant: str,
    advisor: str,
    seed: int,
    preset: str = "clear",
    model: ModelCfg | None = None,
    inbox: Path | None = None,
    draw: Draw | None = None,
) -> dict[str, Any]:
    """Run a mission. The same arguments give the same mission as `coral reef run`.

    `cfg` and `world` have the values of `variant` and `preset`, whose names are for the record.

    Returns:
        Metrics and timing, with `topology`, `covered_at_s` (times at which clusters were covered, s) and `fallback`
        (the policy for decisions that the advisor did not make).

    Raises:
        RunError: The mission was interrupted.
    """
    cfg = dataclasses.replace(cfg, record=RecordCfg(pictures=draw is not None, frames=False, report=False, video=False))
    cfg = with_deadline(cfg, asks_person(advisor))
    asked = reef_advisor(advisor, seed, inbox=inbox, model=model)
    result = Mission(world, cfg, asked, folder, seed=seed, variant=variant, preset=preset, draw=draw).run()
    if result["end_reason"].startswith("stopped by"):
        raise RunError(result["end_reason"])
    return {**result, "topology": world.topology, "covered_at_s": covered_at(folder), "fallback": cfg.pilot.fallback}
