"""Baselines and ablations of the contact pipeline, by name (Table 1)."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from coral.advisor.consult import Attempt
from coral.advisor.log import AttemptRecorder
from coral.advisor.model_cfg import ModelCfg
from coral.advisor.question import Advisor
from coral.advisor.registry import make_advisor
from coral.advisor.setting import known_mistakes
from coral.config import checked
from coral.contact.cost_program.worker import CostWorker
from coral.contact.memory.memory import Memory
from coral.contact.scene.task import Task
from coral.contact.scene.trial import PhysicalParameters
from coral.contact.thinker.asker import Asker
from coral.contact.thinker.strategist import FixedStrategist, Strategist
from coral.contact.thinker.think_cfg import ThinkCfg, decision_budget
from coral.contact.thinker.thinker import Thinker
from coral.contact.thinker.thinking_clock import ThinkingClock, thinking_latency
from coral.errors import InputError, nearest
from coral.plugins import our_part


def contact_model() -> ModelCfg:
    """Return defaults for calling a real model: it writes programs, so it gets more time and tokens than in reef."""
    return ModelCfg(attempt_timeout_s=120.0, deadline_s=180.0, max_output_tokens=16_384)


def contact_advisor(
    spec: str, model: ModelCfg, inbox: Path | None = None, *, key: Sequence[int] = (0,), where: str = "--advisor"
) -> Advisor:
    """Make an advisor of tasks, for which there are no rules; `key` seeds an advisor with errors.

    Raises:
        InputError: What `make_advisor` raises.
    """
    rng, cfg = np.random.default_rng(key), checked(model, "--model")
    mistakes = known_mistakes("contact")
    return make_advisor(spec, rules={}, rng=rng, inbox=inbox, cfg=cfg, where=where, mistakes=mistakes)


@dataclass(frozen=True, kw_only=True)
class AdvisorSetup:
    """The advisor of an episode and its settings."""

    advisor: str = "recorded"
    """As on the command line; of a given advisor, its name."""
    given: Advisor | None = None
    """The advisor itself; None to make the one that `advisor` names."""
    seed: int = 0
    """Seed of the trial; the outer loop's random numbers follow from it."""
    world: str = ""
    """Evaluation world, recorded with a success."""
    memory: str | Path | None = None
    """The experience memory, an SQLite file; None for none."""
    folder: Path | None = None
    """Run folder, which logs every attempt; None for no log."""
    inbox: Path | None = None
    """Inbox of the advisor `desk`."""
    think: ThinkCfg = field(default_factory=ThinkCfg)
    """Which parts of the outer loop are enabled, and their thresholds."""
    believe: Mapping[str, PhysicalParameters] = field(default_factory=dict)
    """Prior beliefs about objects, which replace the advisor's estimates."""
    model: ModelCfg = field(default_factory=contact_model)
    """Calls of real models."""


def _lazy_logger(folder: Path | None) -> Callable[[Attempt], None] | None:
    """Make a logger into the run folder; its file is opened at the first question."""
    if folder is None:
        return None
    recorder = functools.cache(lambda: AttemptRecorder(folder))
    return lambda attempt: recorder()(attempt)


VARIANTS = {
    "expert": "One cost for the whole task, written by a person (Table 1: expert, single stage).",
    "expert-fsm": "A cost for each stage and a test for its end, written by a person (Table 1: expert, FSM).",
    "full": "The advisor estimates masses and frictions, writes the cost, says where to touch, and is asked again "
    "when the robot is stuck.",
    "paper": "Asked and planned as in the paper: its prompt, 200 samples with equal noise, one step executed per plan.",
    "no-memory": "`full`, but nothing is stored or looked up.",
    "no-refinement": "`full`, but the advisor is never asked again; a cost that fails in use ends the episode.",
    "unguided": "The paper's *Without Strategy* (4.1.4): one cost of the outcome that does not say where to touch, "
    "no regions, and no memory, because that holds plans with a contact strategy.",
    "no-regions": "`full` without contact regions: the same plan, but nothing guides its samples; it reads the "
    "memory but adds nothing.",
    "unified": "`full`, but one question with a picture asks for masses, frictions, cost and regions at once.",
    "no-tracking": "`full`, but the advisor guesses the poses once (`object-poses`), and nothing tracks them.",
}
"""What each variant is."""
PARTS: Mapping[str, Mapping[str, Any]] = {
    "no-refinement": {"refine": False},
    "unguided": {"strategy": False},
    "no-regions": {"regions": False},
    "unified": {"unified": True},
    "no-tracking": {"tracking": False},
}
"""Parts of `ThinkCfg` that a variant enables or disables. `paper` asks the same; `of_variant` makes its planner."""
ALONE = ("expert", "expert-fsm")
"""Variants without an advisor."""
REMEMBERING = ("full", "paper", "no-refinement", "no-regions", "no-tracking")
"""Variants that use the experience memory; all but `no-regions` add to it. Remembered plans have a contact strategy,
which `unguided` leaves out, and are looked up by mass and friction, which `unified` asks for with the plan."""


def make_strategist(variant: str, task: Task, asking: AdvisorSetup | None = None) -> Strategist:
    """Make the strategist of a variant.

    Raises:
        InputError: There is no such variant, or it has no strategy for this task.
    """
    check_variant(variant)
    asking = asking or AdvisorSetup()
    if variant in ALONE:
        return FixedStrategist(our_part("experts", "cost", "--variant")(task.known, variant))
    known = asking.memory if variant in REMEMBERING else None
    think = dataclasses.replace(asking.think, **PARTS.get(variant, {}))
    think = dataclasses.replace(think, regions=think.regions and think.strategy)
    advisor = asking.given or contact_advisor(asking.advisor, asking.model, asking.inbox, key=(asking.seed, 2))
    latency = thinking_latency(think.latency, advisor, asking.advisor)
    clock = ThinkingClock(latency, np.random.default_rng([asking.seed, 7]))
    budget = decision_budget(asking.think.budget, asking.advisor)
    return Thinker(
        Asker(advisor, budget, _lazy_logger(asking.folder), clock=clock),
        think,
        np.random.default_rng([asking.seed, 3]),
        CostWorker(),
        None if known is None else Memory(known),
        {
            "world": asking.world,
            "seed": asking.seed,
            "variant": variant,
            "advisor": asking.advisor,
            "run": "" if asking.folder is None else asking.folder.name,
        },
        asking.believe,
    )


def check_variant(variant: str, where: str = "--variant") -> None:
    """Check that a variant exists.

    Raises:
        InputError: There is no such variant.
    """
    if variant not in VARIANTS:
        raise InputError(where, "", repr(variant), f"one of {', '.join(VARIANTS)}{nearest(variant, VARIANTS)}")
