"""An episode that identifies an object's mass and friction during a task, from a wrong belief (Fig. 4).

There are no probing motions: the object is pushed, pinched and lifted as the task requires, and the history is replayed
at intervals.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.episode import Episode
from coral.contact.episode.variants import AdvisorSetup, make_strategist
from coral.contact.scene.trial import PhysicalParameters, Trial, with_beliefs
from coral.contact.thinker.think_cfg import resolved
from coral.run_files import RunFiles
from coral.run_loop import Observer
from coral.runs import read_events


@dataclasses.dataclass(frozen=True)
class Found:
    """Beliefs about the object over the episode."""

    corrections: tuple[Mapping[str, Any], ...]
    """Events `correction` with their time `t`, if there was a history to replay."""
    end_reason: str
    """End reason of the episode."""
    sim_time_s: float
    """Simulated duration of the episode."""


def probe_episode(
    trial: Trial,
    name: str,
    truth: PhysicalParameters,
    first: PhysicalParameters,
    cfg: EpisodeCfg,
    folder: Path,
    world: str = "panda",
    observer: Observer[Episode] | None = None,
) -> Found:
    """Run a task and correct the belief during it.

    Args:
        trial: The trial; everything but the object's true parameters is taken from it.
        name: Name of the object.
        truth: Its true parameters: in the evaluation world, and nowhere else.
        first: The prior belief: in the planning world, and nowhere else.
        cfg: The episode; its `think` sets the interval of corrections.
        folder: Run folder, new or empty.
        world: The evaluation world.
        observer: Watches the episode.
    """
    real = with_beliefs(trial, {**{key: item.physical for key, item in trial.objects.items()}, name: truth})
    strategist = make_strategist(
        "full",
        trial.task,
        AdvisorSetup(
            seed=trial.seed,
            world=world,
            folder=folder,
            think=resolved(cfg.think, cfg.controller, "recorded"),
            believe={name: first},
        ),
    )
    episode = Episode(real, world, strategist, cfg, folder, variant="full", advisor="recorded")
    result = episode.run([] if observer is None else [observer])
    events = read_events(folder / RunFiles.EVENTS)
    told = tuple(
        event for event in events if event["event"] == "correction" and event["object"] == name and "after" in event
    )
    return Found(told, str(result["end_reason"]), float(result["sim_time_s"]))
