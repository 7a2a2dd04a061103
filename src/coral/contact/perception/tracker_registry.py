"""The trackers by name: `--tracker`, its help and its errors follow from this registry."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from coral.contact.perception.foundationpose import CONNECT_S, URL, FoundationPoseCfg, FoundationPoseTracker, exchange
from coral.contact.perception.model_tracker import ModelTracker
from coral.contact.perception.object_model import ObjectModel
from coral.contact.perception.tracker import PoseTracker
from coral.contact.scene.observation import Array
from coral.errors import InputError, nearest


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


TRACKERS = {
    "model": ("model", "the embedded tracker (the default)"),
    "foundationpose": ("foundationpose:http://HOST:PORT", "a FoundationPose server"),
}
"""By name: form of the value after `--tracker`, and description, as half a sentence."""


def tracker_help() -> str:
    """List the trackers with their descriptions, for the command line's help."""
    return "; or ".join(f"{form}, {what}" for form, what in TRACKERS.values())


def choose_tracker(
    word: str, server: FoundationPoseCfg | None = None, where: str = "--tracker", field: str = ""
) -> TrackerChoice:
    """Choose a tracker by its NAME, or NAME:ADDRESS for one on a server unless its configuration has the address.

    Raises:
        InputError: There is no such tracker.
    """
    name, _, address = word.partition(":")
    cfg = server or FoundationPoseCfg()
    cfg = replace(cfg, url=address or cfg.url)
    if word == "model":
        return TrackerChoice("model", ModelTracker)
    if name == "foundationpose" and URL.fullmatch(cfg.url):
        return TrackerChoice(
            "foundationpose",
            lambda shape, expected: FoundationPoseTracker(shape, cfg, expected),
            wants_colours=True,
            check=lambda: exchange(cfg.url, "", b"", CONNECT_S),
        )
    forms = " or ".join(form for form, _ in TRACKERS.values())
    raise InputError(where, field, repr(word), f"{forms}{'' if name in TRACKERS else nearest(name, TRACKERS)}")
