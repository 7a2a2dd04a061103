"""Runs a served policy, from the connection to the metrics."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.policy_cfg import ClientCfg
from coral.contact.policy.address import Address, parse_address
from coral.contact.policy.client import OUTAGES, PolicyClient, PolicyError
from coral.contact.policy.policy_episode import PolicyEpisode
from coral.contact.scene.task import Task
from coral.contact.scene.trial import Trial, sample_trial
from coral.errors import RunError
from coral.run_loop import Observer
from coral.runs import new_run_folder


@contextmanager
def serving(address: Address, cfg: ClientCfg) -> Iterator[PolicyClient]:
    """Yield a connected client and disconnect it at the end.

    Raises:
        RunError: There is no policy server.
    """
    client = PolicyClient(address.url, cfg)
    try:
        try:
            client.connect()
        except PolicyError as error:
            raise RunError(f"no policy: {error.code}: {error}") from None
        yield client
    finally:
        client.close()


def run_policy_episode(
    task: Task, cfg: EpisodeCfg, folder: Path, *, world: str, address: Address, seed: int
) -> dict[str, Any]:
    """Run an episode as a campaign does; see `coral.contact.episode.campaign_episode.run_episode`.

    Raises:
        RunError: The episode was interrupted, or the server could not be reached: no result of the policy.
    """
    cfg = dataclasses.replace(cfg, record=dataclasses.replace(cfg.record, report=False, video=False))
    with serving(address, cfg.policy.client) as client:
        episode = PolicyEpisode(sample_trial(task, seed), world, client, cfg, folder, address)
        result = episode.run()
    reason = str(result["end_reason"])
    if reason.startswith("stopped by") or reason.removeprefix("policy: ") in OUTAGES:
        raise RunError(f"{reason}: {episode.detail}" if episode.detail else reason)
    return {**result, "evaluation_world": world}


def run_served_policy(
    policy: str,
    trial: Trial,
    world: str,
    cfg: EpisodeCfg,
    out: Path | None,
    observers: Sequence[Observer[Any]],
    taken: Collection[str] = (),
) -> tuple[dict[str, Any], Path]:
    """Run an episode with the policy at `[NAME=]ws://HOST:PORT`.

    Without `out`, the run folder is the next free runs/TASK-NNN, made once the server has answered. The policy may not
    have a `taken` name.

    Raises:
        InputError: The address is none.
        RunError: There is no policy server.
    """
    address = parse_address(policy, taken)
    with serving(address, cfg.policy.client) as client:
        folder = out or new_run_folder(Path("runs"), trial.task.name)
        episode = PolicyEpisode(trial, world, client, cfg, folder, address)
        return episode.run(observers), folder
