"""The trackers by name: `--tracker`, its help and its errors follow from this registry."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.foundationpose import FoundationPoseCfg, FoundationPoseTracker
from coral.contact.perception.foundationpose_client import CONNECT_S, URL, exchange
from coral.contact.perception.model_tracker import ModelTracker
from coral.contact.perception.object_model import ObjectModel
from coral.contact.perception.tracker import PoseTracker
from coral.errors import InputError, nearest

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class TrackerCfgs:
    """The configuration of each tracker that has one."""

    foundationpose: FoundationPoseCfg = field(default_factory=FoundationPoseCfg)
    """Configuration of `foundationpose`."""


@dataclass(frozen=True)
class TrackerChoice:
    """A chosen tracker."""

    name: str
    """Name for records."""
    make: Callable[[ObjectModel, Array | None], PoseTracker]
    """Makes a tracker for an object that is expected at T_world_object, Shape=(4, 4), or None: with its axes along the
    world's."""
    wants_colours: bool = False
    """Whether its pictures need colours."""
    check: Callable[[], object] = lambda: None
    """Raises TrackerFailed if no tracker could be made."""


@dataclass(frozen=True)
class TrackerKind:
    """A tracker on the command line."""

    form: str
    """Form of the value after `--tracker`."""
    help: str
    """Description, as half a sentence."""
    choose: Callable[[str, TrackerCfgs], TrackerChoice | None]
    """The choice for an address ("" without one) and the configurations; None where the address is none."""


def _choose_model(address: str, cfgs: TrackerCfgs) -> TrackerChoice | None:
    return None if address else TrackerChoice("model", ModelTracker)


def _choose_foundationpose(address: str, cfgs: TrackerCfgs) -> TrackerChoice | None:
    cfg = replace(cfgs.foundationpose, url=address or cfgs.foundationpose.url)
    if not URL.fullmatch(cfg.url):
        return None
    return TrackerChoice(
        "foundationpose",
        lambda shape, expected: FoundationPoseTracker(shape, cfg, expected),
        wants_colours=True,
        check=lambda: exchange(cfg.url, "", b"", CONNECT_S),
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
    name, _, address = word.partition(":")
    kind = TRACKERS.get(name)
    choice = kind.choose(address, cfgs or TrackerCfgs()) if kind else None
    if choice is None:
        forms = " or ".join(kind.form for kind in TRACKERS.values())
        raise InputError(where, field, repr(word), f"{forms}{'' if kind else nearest(name, TRACKERS)}")
    return choice


def drop_addresses(content: dict[str, Any]) -> None:
    """Remove server addresses from the mapping of a `TrackerCfgs`: poses do not depend on them."""
    content["foundationpose"].pop("url")
