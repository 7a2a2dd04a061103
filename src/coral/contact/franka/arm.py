"""The interface between the stream and an arm: read, follow a target, open and close, stop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from coral.contact.scene.observation import Array, HandTarget


class ArmError(RuntimeError):
    """The arm refused a command, or its link is down."""


@dataclass(frozen=True)
class ArmState:
    """What the arm measures, in its base frame."""

    time_s: float
    """The arm's own clock."""
    joints: Array
    """Shape=(7,) rad."""
    joint_speeds: Array
    """Shape=(7,) rad/s."""
    position: Array
    """Shape=(3,) m, of the tool."""
    quaternion: Array
    """Shape=(4,), of the tool."""
    twist: Array
    """Shape=(6,) velocity of the tool (m/s) and angular velocity (rad/s)."""
    wrench: Array
    """Shape=(6,) force (N) and torque (N m) of the surroundings on the hand, as the arm estimates them: with bias and
    noise."""
    opening_m: float
    """Distance between the finger pads."""
    fault: str = ""
    """Why the arm does not obey (a reflex, the user's stop button); "" while it does."""


class Arm(Protocol):
    """An arm with a gripper. No method may wait for the end of a motion."""

    def read(self) -> ArmState:
        """Return the newest state.

        Raises:
            ArmError: There is none.
        """

    def go_to(self, joints: Array) -> None:
        """Begin a slow motion to a posture, Shape=(7,) rad."""

    def arrived(self) -> bool:
        """Return whether the motion of `go_to` has ended.

        Raises:
            ArmError: It was aborted.
        """

    def follow(self, target: HandTarget) -> None:
        """Pull the tool towards a target in the base frame, as a spring; the first call begins the motion.

        Raises:
            ArmError: The arm does not obey.
        """

    def open_to(self, opening_m: float) -> None:
        """Command an opening of the gripper, at every tick; closing on an object holds it with the gripper's force."""

    def stop(self) -> None:
        """Stop all motion of the arm; the gripper keeps its hold. Never raises."""

    def close(self) -> None:
        """Release the connection. Never raises."""
