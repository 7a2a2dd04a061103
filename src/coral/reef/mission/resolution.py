"""From what a user asks for to a mission: its configuration (preset, fallback, variant, deadline), and who decides."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection
from pathlib import Path

import numpy as np

from coral.advisor.consult import DEADLINE_S
from coral.advisor.fallback import Fallback
from coral.advisor.model_cfg import ModelCfg
from coral.advisor.question import Advisor
from coral.advisor.registry import make_advisor
from coral.advisor.setting import known_mistakes
from coral.config import checked, merge
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.presets import CLEAR, apply_preset
from coral.reef.mission.variants import apply_variant
from coral.reef.world.world import ReefWorld

PERSON_DEADLINE_S = 600.0
"""Default deadline of a person's answer; a model has a minute."""


def resolve_mission(
    cfg: MissionCfg,
    world: ReefWorld,
    *,
    variant: str = "full",
    preset: str = CLEAR,
    fallback: Fallback | None = None,
    keep: Collection[str] = (),
    asks_people: bool = False,
) -> tuple[MissionCfg, ReefWorld]:
    """Return configuration and world of a mission, the same for the command line and for Python.

    `fallback` is what happens where the advisor does not decide; None as configured. Keys in `keep` win over the
    preset. A person who may answer gets more time.

    Raises:
        InputError: A name is unknown or a value out of range.
    """
    cfg, world = apply_preset(preset, cfg, world, keep)
    if fallback is not None:
        cfg = merge(cfg, {"pilot": {"fallback": fallback}}, "--fallback")
    return with_deadline(checked(apply_variant(variant, cfg), "--cfg"), asks_people), world


def reef_advisor(
    name: str,
    seed: int = 0,
    *,
    inbox: Path | None = None,
    model: ModelCfg | None = None,
    where: str = "--advisor",
) -> Advisor:
    """Make the advisor of a survey as `make_advisor` does, with the reef's rules and errors.

    `seed` is that of the mission.

    Raises:
        InputError: The string names no advisor, or something that it needs is missing.
    """
    return make_advisor(
        name,
        rules=REEF_RULES,
        rng=np.random.default_rng([seed, 7]),
        inbox=inbox,
        cfg=checked(model or ModelCfg(), "--model"),
        where=where,
        mistakes=known_mistakes("reef"),
    )


def with_deadline(cfg: MissionCfg, asks_people: bool) -> MissionCfg:
    """Return the configuration with a deadline for answers, where it has none."""
    budget = cfg.pilot.budget.within(PERSON_DEADLINE_S if asks_people else DEADLINE_S)
    return dataclasses.replace(cfg, pilot=dataclasses.replace(cfg.pilot, budget=budget))


def with_sonar(cfg: MissionCfg, there: bool = True) -> MissionCfg:
    """Return the configuration of a vehicle that has the sonar, or has not."""
    return merge(cfg, {"simulator": {"sonar": {"enabled": there}}}, "--cfg")
