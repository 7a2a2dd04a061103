"""Preflight of a campaign: one small question to each of its models with pending episodes."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from coral.advisor.preflight import preflight
from coral.advisor.question import Advisor
from coral.campaign.spec import NO_ADVISOR, Spec
from coral.campaign.store import Store


def preflight_campaign(
    store: Store,
    specs: Sequence[Spec],
    make: Callable[[str], Advisor],
    *,
    pictures: bool,
    retry_failed: bool = False,
    quiet: bool = False,
) -> None:
    """Ask the models of the pending episodes; write nothing.

    Args:
        store: Store of the campaign; it need not exist yet.
        specs: Requested episodes.
        make: Makes the advisor of a string.
        pictures: Whether questions have pictures.
        retry_failed: Whether the campaign repeats failed episodes.
        quiet: Whether to print nothing on standard error.

    Raises:
        InputError: A model cannot be used.
    """
    pending = store.pending(specs, retry_failed=retry_failed) if store.manifest_path.exists() else specs
    for advisor in dict.fromkeys(spec.advisor for spec in pending if spec.advisor != NO_ADVISOR):
        preflight(make(advisor), pictures=pictures, where="--advisors", quiet=quiet)
