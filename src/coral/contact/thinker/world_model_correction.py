"""World-model correction (section 3.4): replay the history and adopt the parameters that explain it better."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from coral.advisor.question import Rejection
from coral.contact.control.planning_world import PlanningWorld
from coral.contact.scene.facts import SceneFacts
from coral.contact.scene.observation import Observation, Transition
from coral.contact.scene.trial import Trial
from coral.contact.thinker.asker import Asker
from coral.contact.thinker.think_cfg import ThinkCfg
from coral.contact.world_model.corrected_parameters import ParametersAnswer, verify_parameters
from coral.contact.world_model.force_balance import LEAST, balances
from coral.contact.world_model.history_replay import HistoryReplay, compare_motions, most_informative_object, windows
from coral.contact.world_model.identification import BETTER, fit_by_balance, fit_by_replay, replay_errors

REPLAY_DT_S = 0.004
"""Longest physics step in replays, finer than in rollouts."""
SUNK_M = 0.002
"""Windows in which an object begins deeper in the table than this are not replayed."""


def correct_beliefs(
    asker: Asker,
    name: str,
    now: Observation,
    steps: Sequence[Transition],
    rows: Sequence[Mapping[str, Any]],
    trial: Trial,
    world: PlanningWorld,
    facts: SceneFacts,
    cfg: ThinkCfg,
    rng: np.random.Generator,
    emit: Callable[..., None],
) -> bool:
    """Correct the believed mass and friction of an object, if there is enough to replay; an advisor may keep them.

    `steps` are all of the episode: those taken while stuck say little about a push that went wrong earlier. `rows` are
    the last ones, as prompts show them. Returns whether they were corrected.
    """
    # A rollout that begins inside the table throws the object out: replay only windows that begin at a possible pose.
    stretches = windows(steps, name, usable=lambda start: trial.lowest_point(name, start.objects[name]) > -SUNK_M)
    if len(stretches) < 2:
        emit("correction", object=name, accepted=False, text="too little was touched or moved to replay")
        return False
    believed = dict(world.beliefs[0])
    step_s = world.cfg.step_s
    finer_s = step_s / math.ceil(step_s / REPLAY_DT_S - 1e-9)
    finer = PlanningWorld(trial, believed, now, replace(world.cfg, physics_dt_s=finer_s))
    try:
        replay = HistoryReplay(finer, stretches)
        found = balances(steps, name, trial) if cfg.identify.by == "balance" else None
        if found is None or len(found) < LEAST:
            fit = fit_by_replay(replay, name, believed, rng)
        else:
            fit = fit_by_balance(found, replay, name, believed)
        tried = [fit.error_before, fit.error_after]

        told = {
            key: {"mass": float(f"{one.mass_kg:.4g}"), "friction": float(f"{one.friction:.4g}")}
            for key, one in believed.items()
        }
        kept = f"mass {told[name]['mass']:g}, friction {told[name]['friction']:g} for {name}"

        def wrong(answer: ParametersAnswer) -> Rejection | None:
            refusal = verify_parameters(answer, believed)
            if refusal is not None or answer.keeps(believed):
                return refusal
            before, after = tried[:] = replay_errors(replay, name, believed, answer.physical(believed), found)
            if after < (1.0 - BETTER) * before:
                return None
            return Rejection(
                code="replay",
                reason=f"replayed with your values, the history is explained no better "
                f"(error {after:.2f}, now {before:.2f}); propose others, or keep the values by giving them as they "
                f"are: {kept}",
            )

        fitted = {"object": name, "mass_kg": fit.after.mass_kg, "friction": fit.after.friction, "better": fit.accepted}
        asked: SceneFacts = {**facts, "fitted": fitted}
        prompt = {
            "task": facts["instruction"],
            "parameters": told,
            "object": name,
            "replayed": compare_motions(replay, name, believed),
            "history": rows,
        }
        outcome = asker.ask("parameter-repair", ParametersAnswer, asked, prompt, wrong)
    finally:
        finer.close()
    kept_values = outcome.answer is not None and outcome.answer.keeps(believed)
    if outcome.answer is not None and not kept_values:
        world.believe(outcome.answer.physical(believed))
    after = world.beliefs[0][name]
    emit(
        "correction",
        object=name,
        accepted=outcome.answer is not None and not kept_values,
        text="the values were kept" if kept_values else fit.words(),
        **({} if outcome.answer is None else {"decided": "correction", "source": asker.source}),
        failure=outcome.failure,
        errors=[round(error, 4) for error in tried],
        before=[believed[name].mass_kg, believed[name].friction],
        after=[after.mass_kg, after.friction],
        refused=[rejection.reason for rejection in outcome.rejections],
    )
    return outcome.answer is not None and not kept_values


MOST_CORRECTIONS = 5
"""Maximum number per episode. One is kept for the end: objects are lifted last, and that reveals their weight."""


@dataclass
class CorrectionSchedule:
    """Decides when to correct and for which object, and counts the corrections of an episode."""

    every_s: float
    """Simulated time between two corrections; 0 disables them."""
    done: int = 0
    _since: float = 0.0
    _seen: int = 0

    def due(self, steps: Sequence[Transition], last: bool = False) -> str | None:
        """Return the object to correct now, or None."""
        if not self.every_s or not steps or self.done >= MOST_CORRECTIONS - (not last):
            return None
        now = steps[-1].after.time_s
        if now - self._since < self.every_s - 1e-9 and not last:
            return None
        name = most_informative_object(steps[self._seen :])
        if name is not None:
            self.done, self._since, self._seen = self.done + 1, now, len(steps)
        return name
