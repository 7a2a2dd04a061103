"""The interface of a pose tracker."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame
from coral.contact.scene.observation import Array
from coral.errors import RunError


@dataclass(frozen=True)
class PoseEstimate:
    """Estimated pose of an object."""

    T_world_object: Array
    """Shape=(4, 4). For a lost object, the last pose; before the first one, the expected pose."""
    confidence: float
    """Confidence in this pose, up to 1; 0 for a lost object."""
    lost: bool = False
    """Whether the pose is unreliable."""
    visible: float = 1.0
    """Visible share of the object's drawing."""
    reason: str = ""
    """Why it is lost: "not seen", "covered", "does not fit"; "" otherwise."""
    registered: bool = False
    """Whether the pose comes from registration, not from tracking."""


class TrackerFailed(RunError):
    """A tracker failed, for example because its server does not answer. A lost object is not a failure."""


class PoseTracker(Protocol):
    """Finds and follows one object."""

    def track(self, frame: RgbdFrame, mask: NDArray[np.bool_], guess: Array | None = None) -> PoseEstimate:
        """Track the object into the next picture, or find it if it is not tracked.

        `guess` is a possible pose, T_world_object, Shape=(4, 4), for example because the hand carries the object. A
        tracker may ignore this hint.

        Raises:
            TrackerFailed: The tracker failed.
        """

    def close(self) -> None:
        """Release remote resources, for example on a server; never fails, and may be called again."""
