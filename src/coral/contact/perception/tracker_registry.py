"""The trackers by name: `--tracker`, its help and its errors follow from this registry."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from coral.contact.perception.foundationpose import CONNECT_S, URL, FoundationPoseTracker, exchange
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
    "model": "the embedded tracker (the default)",
    "foundationpose:http://HOST:PORT": "a FoundationPose server",
}
"""Description of each form of the value after `--tracker`, as half a sentence."""


def choose_tracker(word: str, where: str = "--tracker", field: str = "") -> TrackerChoice:
    """Choose a tracker by its NAME, or NAME:ADDRESS for one on a server.

    Raises:
        InputError: There is no such tracker.
    """
    name, _, url = word.partition(":")
    if word == "model":
        return TrackerChoice("model", ModelTracker)
    if name == "foundationpose" and URL.fullmatch(url):
        return TrackerChoice(
            "foundationpose",
            lambda shape, expected: FoundationPoseTracker(shape, url, expected),
            wants_colours=True,
            check=lambda: exchange(url, "", b"", CONNECT_S),
        )
    names = [form.partition(":")[0] for form in TRACKERS]
    expected = f"{' or '.join(TRACKERS)}{'' if name in names else nearest(name, names)}"
    raise InputError(where, field, repr(word), expected)
