"""One episode of a campaign: no report; returns all values that the tables need."""

from __future__ import annotations

import dataclasses
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from coral.advisor.model_cfg import ModelCfg
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.resolution import assemble_episode, of_variant
from coral.contact.episode.variants import REMEMBERING, AdvisorSetup, contact_model
from coral.contact.memory.memory import Experience, Memory
from coral.contact.scene.task import Task
from coral.contact.scene.trial import sample_trial
from coral.errors import RunError
from coral.run_files import TaskFiles


def run_episode(
    task: Task,
    cfg: EpisodeCfg,
    folder: Path,
    *,
    world: str,
    variant: str,
    advisor: str,
    seed: int,
    memory: Sequence[Experience] = (),
    model: ModelCfg | None = None,
) -> dict[str, Any]:
    """Run an episode; the same arguments give the same episode as `coral contact run`.

    A variant with memory begins with the experiences in `memory`. Each trial has its own copy, so that trials do not
    depend on each other or on their order; new experiences go into a memory of their own in the run folder.

    Returns metrics and timing, with `evaluation_world`, `fallback` (the policy), and `memory_known`, the number of
    experiences at the start.

    Raises:
        RunError: The episode was interrupted, or its tracker failed: no result of the variant.
    """
    cfg = of_variant(cfg, variant)
    cfg = dataclasses.replace(cfg, record=dataclasses.replace(cfg.record, report=False, video=False))
    with tempfile.TemporaryDirectory() as aside:
        own, known = Memory(Path(aside) / "memory.sqlite") if variant in REMEMBERING else None, None
        if own is not None:
            for one in memory:
                own.add(one)
            known = len(own.all())  # fewer, where one of a foreign file cannot be read again
        asking = AdvisorSetup(
            advisor=advisor, world=world, memory=None if own is None else own.where, model=model or contact_model()
        )
        episode = assemble_episode(sample_trial(task, seed), world, cfg, folder, variant=variant, asking=asking)
        result = episode.run()
        if own is not None:
            for stored in own.all()[known:]:
                Memory(folder / TaskFiles.REMEMBERED).add(stored.experience)
    if result["end_reason"].startswith("stopped by"):
        raise RunError(result["end_reason"])
    if result["end_reason"] == "tracker-failed":
        raise RunError(f"tracker-failed: {episode.detail}")
    return {**result, "evaluation_world": world, "fallback": cfg.think.fallback, "memory_known": known}
