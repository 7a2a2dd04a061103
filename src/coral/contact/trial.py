"""One episode as a campaign runs it: no report, everything that the tables need returned."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

from coral.contact.draw import draw
from coral.contact.episode import Episode, EpisodeCfg
from coral.contact.task import Task
from coral.contact.variants import Asking, make_mind
from coral.errors import RunError


def run_trial(task: Task, cfg: EpisodeCfg, folder: Path, *, world: str, variant: str, advisor: str, seed: int
              ) -> dict[str, Any]:
    """Run an episode; the same arguments give the same episode as `coral contact run`.

    Args:
        task: What is asked for.
        cfg: Of the episode.
        folder: Run folder; it keeps logs, states and metrics.
        world: Name of the evaluation world.
        variant: Name of the variant.
        advisor: As on the command line; "none" for a variant that asks nobody.
        seed: Of everything random.

    Returns:
        Metrics and timing, with `evaluation_world`.

    Raises:
        RunError: The episode was interrupted.
    """
    cfg = dataclasses.replace(cfg, record=dataclasses.replace(cfg.record, report=False, video=False))
    # A table's trials are independent of each other: nothing is remembered from one to the next.
    mind = make_mind(variant, task, Asking(advisor=advisor, seed=seed, world=world, folder=folder, think=cfg.think))
    result = Episode(draw(task, seed), world, mind, cfg, folder, variant=variant, advisor=advisor).run()
    if result["end_reason"].startswith("stopped by"):
        raise RunError(result["end_reason"])
    return {**result, "evaluation_world": world}
