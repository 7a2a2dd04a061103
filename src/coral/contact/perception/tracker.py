"""The interface of a pose tracker: `register` finds an object, `track` follows it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame
from coral.errors import RunError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PoseEstimate:
    """Where an object is believed to be."""

    T_world_object: Array
    """Shape=(4, 4). For a lost object, the last pose; before the first one, the expected pose."""
    confidence: float
    """In this pose, up to 1; 0 for a lost object."""
    lost: bool = False
    """Whether the pose cannot be relied on."""
    visible: float = 1.0
    """Share of the object's drawing that is visible."""
    reason: str = ""
    """Why it is lost: "not seen", "covered", "does not fit"; "" otherwise."""
    registered: bool = False
    """Whether the pose comes from registration, not from tracking."""


class TrackerFailed(RunError):
    """A tracker cannot go on, as when its server does not answer. A lost object is not a failure."""


class PoseTracker(Protocol):
    """Finds and follows one object. The verbs are FoundationPose's.

    Attributes:
        name: For records.
        wants_colours: Whether its pictures must have colours; otherwise none are drawn.
    """

    name: str
    wants_colours: bool

    def register(self, frame: RgbdFrame, mask: NDArray[np.bool_]) -> PoseEstimate:
        """Find the object without a previous pose.

        Args:
            frame: The picture.
            mask: Shape=(H, W), where the object is seen in it.

        Raises:
            TrackerFailed: The tracker cannot go on.
        """
        ...

    def track(self, frame: RgbdFrame, mask: NDArray[np.bool_], guess: Array | None = None) -> PoseEstimate:
        """Track the object into the next picture.

        Args:
            frame: The picture.
            mask: Shape=(H, W), where the object is seen in it.
            guess: T_world_object, Shape=(4, 4), where the object may be, as when the hand carries it. A tracker may
                ignore this hint.

        Raises:
            TrackerFailed: The tracker cannot go on.
        """
        ...

    def close(self) -> None:
        """Release what is held elsewhere, as on a server; never fails, and may be called again."""
        ...
