"""The trackers by name: `--tracker`, its help and its errors follow from this registry."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.foundationpose import FoundationPoseCfg, FoundationPoseTracker
from coral.contact.perception.foundationpose_client import parse_url, reach
from coral.contact.perception.model_tracker import ModelTracker, TrackerCfg
from coral.contact.perception.object_model import ObjectModel
from coral.contact.perception.tracker import PoseTracker
from coral.errors import InputError, nearest

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class TrackerCfgs:
    """One configuration for each tracker."""

    tracker: TrackerCfg = field(default_factory=TrackerCfg)
    """Configuration of `model`, the embedded tracker."""
    foundationpose: FoundationPoseCfg = field(default_factory=FoundationPoseCfg)
    """Configuration of `foundationpose`."""


@dataclass(frozen=True)
class TrackerChoice:
    """A chosen tracker."""

    name: str
    """Name for records."""
    wants_colours: bool
    """Whether its pictures need colours."""
    make: Callable[[ObjectModel, Array | None], PoseTracker]
    """Makes a tracker for an object that is expected at T_world_object, Shape=(4, 4), or None: with its axes along the
    world's."""
    check: Callable[[], None]
    """Raises TrackerFailed if no tracker could be made."""


@dataclass(frozen=True)
class TrackerKind:
    """A tracker on the command line."""

    form: str
    """Form of the value after `--tracker`."""
    help: str
    """Description, as half a sentence."""
    choose: Callable[[str | None, TrackerCfgs, tuple[str, str]], TrackerChoice | None]
    """The choice for an address (what follows the first colon; None without a colon), the configurations, and the place
    of the word, for errors; None where the word is not of this form."""


def _choose_model(address: str | None, cfgs: TrackerCfgs, place: tuple[str, str]) -> TrackerChoice | None:
    if address is not None:
        return None
    return TrackerChoice(
        ModelTracker.name,
        ModelTracker.wants_colours,
        lambda shape, expected: ModelTracker(shape, cfgs.tracker, expected),
        lambda: None,
    )


def _choose_foundationpose(address: str | None, cfgs: TrackerCfgs, place: tuple[str, str]) -> TrackerChoice | None:
    cfg = cfgs.foundationpose if address is None else replace(cfgs.foundationpose, url=address)
    if not cfg.url:
        return None
    parse_url(cfg.url, *place)
    return TrackerChoice(
        FoundationPoseTracker.name,
        FoundationPoseTracker.wants_colours,
        lambda shape, expected: FoundationPoseTracker(shape, cfg, expected),
        lambda: reach(cfg.url, cfg.connect_s),
    )


TRACKERS: dict[str, TrackerKind] = {
    "model": TrackerKind("model", "the embedded tracker (the default)", _choose_model),
    "foundationpose": TrackerKind("foundationpose:http://HOST:PORT", "a FoundationPose server", _choose_foundationpose),
}


def tracker_help() -> str:
    """List the trackers with their descriptions, for the command line's help."""
    return "; or ".join(f"{kind.form}, {kind.help}" for kind in TRACKERS.values())


def choose_tracker(
    word: str, cfgs: TrackerCfgs | None = None, where: str = "--tracker", field: str = ""
) -> TrackerChoice:
    """Choose a tracker by its name.

    Args:
        word: NAME, or NAME:ADDRESS for a tracker on a server; NAME alone if the configuration has the address.
        cfgs: The trackers' configurations.
        where: Source of the word, for errors.
        field: Field of the word, for errors.

    Raises:
        InputError: There is no such tracker.
    """
    name, separator, address = word.partition(":")
    kind = TRACKERS.get(name)
    choice = kind.choose(address if separator else None, cfgs or TrackerCfgs(), (where, field)) if kind else None
    if choice is None:
        forms = " or ".join(kind.form for kind in TRACKERS.values())
        raise InputError(where, field, repr(word), f"{forms}{'' if kind else nearest(name, TRACKERS)}")
    return choice


def drop_addresses(content: dict[str, Any]) -> None:
    """Remove server addresses from the mapping of a `TrackerCfgs`: poses do not depend on them."""
    content["foundationpose"].pop("url")
