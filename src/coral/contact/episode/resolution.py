"""From what a user asks for to the episode: what goes together, rollouts, poses, fallback; strategist and world."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Literal

from coral.config import checked
from coral.contact.control.hand_controllers import MakeHandController
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.episode import Episode
from coral.contact.episode.own_cost import OwnCost
from coral.contact.episode.referee import OperatorVerdict
from coral.contact.episode.variants import ALONE, REMEMBERING, AdvisorSetup, check_variant, make_strategist
from coral.contact.perception.tracker_registry import choose_tracker
from coral.contact.scene.trial import Trial
from coral.contact.thinker.strategist import FixedStrategist, Strategist
from coral.contact.thinker.think_cfg import StandIn, Told
from coral.contact.worlds.robot_world import RobotWorld
from coral.errors import InputError

DEFAULT_ADVISOR, DEFAULT_VARIANT = "recorded", "full"
OWN_COST = "own-cost"
"""Variant in records of episodes that follow a cost of the user's own."""


def check_combination(
    *,
    variant: str,
    advisor: str,
    seed: int,
    policy: str | None = None,
    cost: str | None = None,
    believe: str | None = None,
    memory: str | None = None,
    tracker: str | None = None,
    prompt: str | None = None,
) -> None:
    """Check that the parts of an episode go together; `cost` is one of the user's own, followed instead of a variant.

    Raises:
        InputError: They do not; the error names the flags.
    """
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise InputError("--seed", "", repr(seed) if not isinstance(seed, int) else seed, "a number of 0 or more")
    check_variant(variant)
    for flag, given in (("--policy", policy), ("--cost", cost)):
        if given is not None and variant != DEFAULT_VARIANT:
            reason = "a policy has no variant" if flag == "--policy" else "a cost of your own has no variant"
            raise InputError(flag, "", f"also --variant {variant}", f"one of the two: {reason}")
    if policy is not None and cost is not None:
        raise InputError("--cost", "", "also --policy", "one of the two: a policy plans nothing")
    which = "--policy" if policy is not None else "--cost" if cost is not None else f"--variant {variant}"
    instead = policy is not None or cost is not None
    if advisor != DEFAULT_ADVISOR and (instead or variant in ALONE):
        expected = "a variant that asks an advisor, such as --variant full"
        raise InputError("--advisor", "", f"{advisor} with {which}", expected)
    if prompt is not None and (instead or variant in ALONE):
        raise InputError("--prompt", "", f"also {which}", "a variant that asks an advisor, such as full")
    if believe is not None and (instead or variant in (*ALONE, "unified")):
        raise InputError("--believe", "", f"also {which}", "a variant that asks for masses and frictions, such as full")
    if memory is not None and (instead or variant not in REMEMBERING):
        expected = f"a variant that remembers, such as full ({', '.join(REMEMBERING)})"
        raise InputError("--memory", "", f"also {which}", expected)
    if tracker is not None and (policy is not None or variant == "no-tracking"):
        raise InputError("--tracker", "", f"also {which}", "a variant that tracks the objects")


def resolve_episode(
    cfg: EpisodeCfg,
    *,
    variant: str = DEFAULT_VARIANT,
    samples: int | None = None,
    poses: Literal["tracked", "ground-truth"] | None = None,
    tracker: str | None = None,
    fallback: StandIn | None = None,
    prompt: Told | None = None,
) -> EpisodeCfg:
    """Return the configuration of an episode; None leaves a value as configured.

    The variant `paper` plans and asks as the paper does: K = 200 samples with equal noise, one step executed per plan,
    which is one attempt, and the prompt `paper`.

    Raises:
        InputError: A value is out of range, or there is no such tracker.
    """
    cfg = of_variant(cfg, variant)
    if samples is not None:
        if samples < 1:
            raise InputError("--samples", "", samples, "a number of 1 or more")
        mppi = dataclasses.replace(cfg.controller.mppi, samples=samples)
        cfg = dataclasses.replace(cfg, controller=dataclasses.replace(cfg.controller, mppi=mppi))
    if poses is not None:
        cfg = dataclasses.replace(cfg, poses=poses)
    if tracker is not None:
        choose_tracker(tracker)
        if cfg.poses != "tracked":
            raise InputError("--tracker", "", f"{tracker!r} beside poses from the simulator", "--poses tracked")
        cfg = dataclasses.replace(cfg, tracked=dataclasses.replace(cfg.tracked, by=tracker))
    think = dataclasses.replace(cfg.think, fallback=fallback or cfg.think.fallback, prompt=prompt or cfg.think.prompt)
    return checked(dataclasses.replace(cfg, think=think), "--cfg")


def of_variant(cfg: EpisodeCfg, variant: str) -> EpisodeCfg:
    """Return the configuration of a variant: another one for `paper`, which plans as the paper's section 4 says."""
    if variant != "paper":
        return cfg
    mppi = dataclasses.replace(cfg.controller.mppi, samples=200, fine=0.0)
    controller = dataclasses.replace(cfg.controller, mppi=mppi, press_weight=0.0)
    outer = dataclasses.replace(cfg.think.outer, attempt_s=cfg.planning.step_s)
    think = dataclasses.replace(cfg.think, prompt="paper", outer=outer)
    return dataclasses.replace(cfg, controller=controller, replan_steps=1, think=think)


def assemble_episode(
    trial: Trial,
    world: str | Callable[[], RobotWorld],
    cfg: EpisodeCfg,
    folder: Path,
    *,
    variant: str,
    asking: AdvisorSetup,
    cost: OwnCost | None = None,
    controller: str | MakeHandController = "mppi",
    operator: Callable[[], OperatorVerdict | None] = lambda: None,
) -> Episode:
    """Make an episode of a variant, or of a cost of the user's own, whose source goes into the run folder.

    The world is simulated, by name, or what connects a robot; it is called when all else is right, and `operator`,
    which makes what asks the operator, once the robot is connected. To `asking` the trial's seed, the folder and the
    outer loop's configuration are added. A checked `cost` is followed in place of the variant.

    Raises:
        InputError, RunError: As of `make_strategist` and `Episode`.
    """
    if cost is None:
        asking = dataclasses.replace(asking, seed=trial.seed, folder=folder, think=cfg.think)
        strategist: Strategist = make_strategist(variant, trial.task, asking)
        advisor = "none" if variant in ALONE else asking.advisor
    else:
        strategist, variant, advisor = FixedStrategist(cost.strategy), OWN_COST, "none"
    episode = Episode(
        trial,
        world if isinstance(world, str) else world(),
        strategist,
        cfg,
        folder,
        variant=variant,
        advisor=advisor,
        controller=controller,
        operator_verdict=operator(),
    )
    if cost is not None:
        episode.writer.text(cost.file, cost.text)
    return episode
