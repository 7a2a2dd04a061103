"""Trackers by a word: `model`, the embedded one, or `foundationpose:URL`, one on a server."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.foundationpose import FoundationPoseCfg, FoundationPoseTracker, parse_url, reach
from coral.contact.perception.model_tracker import ModelTracker, TrackerCfg
from coral.contact.perception.object_model import ObjectModel
from coral.contact.perception.tracker import PoseTracker
from coral.errors import InputError

Array = NDArray[np.float64]
WORDS = "model or foundationpose:http://HOST:PORT"


@dataclass(frozen=True)
class TrackerChoice:
    """A tracker that was chosen.

    Args:
        name: For records.
        wants_colours: Whether its pictures must have colours.
        make: One for an object that is expected at T_world_object, Shape=(4, 4), or None: with its axes along the
            world's.
        check: Raises TrackerFailed where none could be made.
    """

    name: str
    wants_colours: bool
    make: Callable[[ObjectModel, Array | None], PoseTracker]
    check: Callable[[], None]


def choose_tracker(
    word: str,
    model: TrackerCfg | None = None,
    server: FoundationPoseCfg | None = None,
    where: str = "--tracker",
    field: str = "",
) -> TrackerChoice:
    """The tracker that a word names.

    Args:
        word: `model`, `foundationpose:URL`, or `foundationpose` alone where the configuration has the URL.
        model: Configuration of the embedded one.
        server: Configuration of the other.
        where: What holds the word, for errors.
        field: Likewise.

    Raises:
        InputError: It names none.
    """
    kind, separator, url = word.partition(":")
    if word == "model":
        return TrackerChoice(
            ModelTracker.name,
            ModelTracker.wants_colours,
            lambda shape, expected: ModelTracker(shape, model, expected),
            lambda: None,
        )
    cfg = server or FoundationPoseCfg()
    if separator or not cfg.url:
        cfg = replace(cfg, url=url)
    if kind != "foundationpose" or not cfg.url:
        raise InputError(where, field, repr(word), WORDS)
    parse_url(cfg.url, where, field)
    return TrackerChoice(
        FoundationPoseTracker.name,
        FoundationPoseTracker.wants_colours,
        lambda shape, expected: FoundationPoseTracker(shape, cfg, expected),
        lambda: reach(cfg),
    )
