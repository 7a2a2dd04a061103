"""Running of a campaign: pending episodes go to the executor, outcomes go to the store."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from statistics import fmean
from typing import Any, cast

from coral.campaign.episode import Episode, EpisodeOutcome, EpisodeTask, Executor, code_version
from coral.campaign.progress import CampaignProgress
from coral.campaign.spec import Spec
from coral.campaign.store import Store
from coral.errors import RunError


@dataclass(frozen=True)
class Summary:
    """Summary of a call of `run_campaign`."""

    wanted: int
    """Number of episodes of this grid."""
    found: int
    """Number of episodes recorded before."""
    finished: int
    """Number of episodes finished by this call."""
    failed: int
    """Number of episodes that failed in this call."""


def run_campaign(
    store: Store,
    specs: Sequence[Spec],
    episode: Episode,
    executor: Executor,
    *,
    retry_failed: bool = False,
    mix: bool = False,
    progress: CampaignProgress | None = None,
) -> Summary:
    """Run the episodes that are not recorded yet. The store must be locked and opened.

    With `retry_failed`, episodes with a recorded failure are repeated; with `mix`, results of workers with another
    version of the code are accepted.

    Raises:
        RunError: A worker runs another version of the code than this process, or its disk is full, or workers do not
            start.
    """
    pending = list(store.pending(specs, retry_failed=retry_failed))
    found = len(specs) - len(pending)
    pending.sort(key=_time_estimator(store), reverse=True)  # the longest first keeps all workers busy to the end
    progress = progress or CampaignProgress(quiet=True)
    progress.begin(len(specs), found, executor.jobs)
    finished = failed = 0
    tasks = [EpisodeTask(spec, store.scratch(spec)) for spec in pending]
    with closing(progress), closing(cast(Any, executor.run(episode, tasks))) as outcomes:
        for outcome in outcomes:
            _check_version(outcome, mix)
            if outcome.no_room:
                raise RunError(f"{outcome.message}; make room, and the same command continues")
            if outcome.result is None:
                store.fail(outcome.spec, outcome.message, outcome.detail, outcome.about)
                failed += 1
            elif store.finish(outcome.spec, outcome.result, outcome.about):
                finished += 1
            progress.ended(outcome)
    return Summary(len(specs), found, finished, failed)


def _check_version(outcome: EpisodeOutcome, mix: bool) -> None:
    there = outcome.about.get("code", code_version())
    if there != code_version() and not mix:
        raise RunError(
            f"a worker on {outcome.about.get('host')} runs another version of coral ({there}) than this "
            f"process ({code_version()}): install the same one everywhere, or give --mix"
        )


def _time_estimator(store: Store) -> Callable[[Spec], float]:
    """Return a function that estimates an episode's time: the mean of its variant and world, variant, or all."""
    times: Mapping[tuple[str, ...], list[float]] = defaultdict(list)
    for record in store.records():
        seconds = record["about"].get("episode_wall_s")
        if record["status"] == "done" and seconds is not None:
            spec = record["spec"]
            times[spec["variant"], spec["world"]].append(seconds)
            times[(spec["variant"],)].append(seconds)

    def expected(spec: Spec) -> float:
        known = times.get((spec.variant, spec.world)) or times.get((spec.variant,))
        return fmean(known) if known else 0.0

    return expected
