"""What a pose tracker is: `register` finds an object, `track` follows it."""

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
    """Where an object is held to be.

    Args:
        T_world_object: Shape=(4, 4). While it is lost, where it was last seen; before it was ever found, where it was
            expected.
        confidence: Of this pose, up to 1; 0 while the object is lost.
        lost: Whether the pose is not to be relied on.
        visible: Share of the object's drawing that is seen.
        reason: Why it is lost: "not seen", "covered", "does not fit"; "" otherwise.
        registered: Whether the pose was found anew instead of followed from the last one.
    """

    T_world_object: Array
    confidence: float
    lost: bool = False
    visible: float = 1.0
    reason: str = ""
    registered: bool = False


class TrackerFailed(RunError):
    """A tracker cannot go on: its server is out of reach, say. That an object is lost is no such failure."""


class PoseTracker(Protocol):
    """Finds and follows one object. The verbs are FoundationPose's.

    Attributes:
        name: For records.
        wants_colours: Whether its pictures must have colours; without, none are made.
    """

    name: str
    wants_colours: bool

    def register(self, frame: RgbdFrame, mask: NDArray[np.bool_]) -> PoseEstimate:
        """Find the object without knowing where it was.

        Args:
            frame: The picture.
            mask: Shape=(H, W), where the object is seen in it.

        Raises:
            TrackerFailed: The tracker cannot go on.
        """
        ...

    def track(self, frame: RgbdFrame, mask: NDArray[np.bool_], guess: Array | None = None) -> PoseEstimate:
        """Follow the object into the next picture.

        Args:
            frame: The picture.
            mask: Shape=(H, W), where the object is seen in it.
            guess: T_world_object, Shape=(4, 4), where the object may be: with the hand that holds it, say. A hint,
                which a tracker may leave alone.

        Raises:
            TrackerFailed: The tracker cannot go on.
        """
        ...

    def close(self) -> None:
        """Give back what is held elsewhere, on a server say; never fails, and may be called again."""
        ...
