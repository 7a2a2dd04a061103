"""Motions for measuring a tracker: objects moved as in the six tasks, with a two-finger hand in the way.

The motions are kinematic, not simulated, so they are the same on every machine. Frames: world, metres, z up; the tool
frame has z out of the palm and y along the opening.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.contact.scene.geometry import rotation_about
from coral.contact.scene.rigid_transform import body_to_matrix, pose_matrix
from coral.contact.scene.trial import Trial

Array = NDArray[np.float64]
_X, _Y, _Z = np.eye(3)
_DOWN = np.diag([-1.0, 1.0, -1.0])
"""Orientation of a hand that points down, with its fingers left and right as seen from the robot."""


@dataclass(frozen=True)
class MotionSample:
    """All poses at one time."""

    objects: dict[str, Array]
    """T_world_object by name, Shape=(4, 4)."""
    tool: Array
    """T_world_tool, Shape=(4, 4)."""
    opening_m: float
    """Distance between the fingers."""


Phase = tuple[float, Callable[[float], MotionSample]]
"""Duration (s), and the poses as a function of the elapsed share, 0 to 1."""


@dataclass(frozen=True)
class Motion:
    """A sequence of phases, each starting and ending at rest."""

    phases: tuple[Phase, ...]

    @property
    def duration_s(self) -> float:
        """Return the duration of all phases."""
        return sum(duration for duration, _ in self.phases)

    def at(self, time_s: float) -> MotionSample:
        """Return the poses at a time, clamped to the start and the end of the motion."""
        for duration, place in self.phases:
            if time_s <= duration:
                share = min(1.0, max(0.0, time_s / duration))
                return place(share * share * (3.0 - 2.0 * share))
            time_s -= duration
        return self.phases[-1][1](1.0)


def motion_of(trial: Trial) -> Motion:
    """Make the motion of a trial's first object, `pick-box`'s for tasks without one; the others stay where they are."""
    return Motion(tuple(MOTIONS.get(trial.task.name, _pick)(HeadedTrial(trial))))


class HeadedTrial:
    """A trial in the heading of its first object: the object's side that is closest to the world's x axis."""

    def __init__(self, trial: Trial) -> None:
        self.main = trial.task.objects[0].name
        self.poses = {name: body_to_matrix(item.pose) for name, item in trial.objects.items()}
        start = self.poses[self.main]
        corners = trial.corners(self.main) @ start[:3, :3].T + start[:3, 3]
        self.fixtures = trial.task.fixtures
        side = max((s * start[:3, k] for k in range(3) for s in (1.0, -1.0)), key=lambda axis: float(axis @ _X))
        self.heading = math.atan2(side[1], side[0])
        turn = rotation_about(_Z, self.heading)
        low, high = (corners @ turn).min(0), (corners @ turn).max(0)
        self.middle = turn @ ((low + high) / 2)
        self.extent = high - low
        self.turn = turn

    def moment(self, tool: Array, opening: float, moved: Array | None = None) -> MotionSample:
        """Return the poses at the start, with the object moved by a transform of the world."""
        objects = dict(self.poses)
        if moved is not None:
            objects[self.main] = moved @ objects[self.main]
        return MotionSample(objects, tool, opening)

    def tool(self, offset: Array, orientation: Array = _DOWN) -> Array:
        """Return a tool pose in the object's heading, at an offset (m) from the object's middle."""
        return pose_matrix(self.turn @ orientation, self.middle + self.turn @ offset)

    def approach(self, tool: Array, opening: float, moved: Array | None = None, seconds: float = 1.5) -> Phase:
        """Make the phase in which the hand approaches from 15 cm behind and above while the object rests."""
        away = pose_matrix(np.eye(3), -0.1 * self.turn[:, 0] + 0.15 * _Z) @ tool

        def place(share: float) -> MotionSample:
            return self.moment(
                pose_matrix(tool[:3, :3], (1 - share) * away[:3, 3] + share * tool[:3, 3]), opening, moved
            )

        return seconds, place

    def carry(
        self,
        tool: Array,
        opening: float,
        seconds: float,
        shift: Array,
        turns: tuple[tuple[Array, float, Array], ...],
        before: Array | None = None,
        upright: bool = False,
    ) -> tuple[Phase, Array]:
        """Make the phase in which hand and object move together; return it and the object's displacement at its end.

        Args:
            tool: T_world_tool before the object moves.
            opening: Distance between the fingers.
            seconds: Duration.
            shift: Shape=(3,) m, world.
            turns: Axis and angle (rad) of rotations about points, Shape=(3,), all in the world; applied in order.
            before: Earlier displacement of the object.
            upright: Whether the hand keeps its orientation and only its tip follows.
        """
        first = np.eye(4) if before is None else before

        def moved(share: float) -> Array:
            total = np.eye(4)
            for axis, angle, point in turns:
                r = rotation_about(axis, share * angle)
                total = pose_matrix(r, point - r @ point) @ total
            return np.asarray(pose_matrix(np.eye(3), share * shift) @ total @ first)

        def place(share: float) -> MotionSample:
            hand = moved(share) @ tool
            return self.moment(pose_matrix(tool[:3, :3], hand[:3, 3]) if upright else hand, opening, moved(share))

        return (seconds, place), moved(1.0)


def _push(scene: HeadedTrial) -> list[Phase]:
    """Push from behind with closed fingers: 20 cm ahead with a left turn, then another way with a right turn."""
    tool = scene.tool(np.array([-scene.extent[0] / 2 - 0.012, 0.0, 0.0]))
    first, moved = scene.carry(tool, 0.0, 2.5, 0.12 * scene.turn[:, 0], ((_Z, 0.35, scene.middle),))
    ahead = 0.08 * scene.turn[:, 0] + 0.05 * scene.turn[:, 1]
    second, _ = scene.carry(tool, 0.0, 2.0, ahead, ((_Z, -0.5, moved[:3, :3] @ scene.middle + moved[:3, 3]),), moved)
    return [scene.approach(tool, 0.0), first, second]


def _pick(scene: HeadedTrial) -> list[Phase]:
    """Grasp from above, lift, carry with a turn, put down, release."""
    tool = scene.tool(np.array([0.0, 0.0, max(0.0, scene.extent[2] / 2 - 0.03)]))
    width = min(0.08, float(scene.extent[1]))
    up, moved = scene.carry(tool, width, 1.5, 0.14 * _Z, ())
    point = moved[:3, 3] + scene.middle
    across, moved = scene.carry(tool, width, 2.0, 0.15 * scene.turn[:, 1], ((_Z, 0.7, point), (_X, 0.25, point)), moved)
    point = moved[:3, :3] @ scene.middle + moved[:3, 3]
    down, moved = scene.carry(tool, width, 1.5, -0.14 * _Z, ((_X, -0.25, point),), moved)
    gone = moved @ tool

    def leave(share: float) -> MotionSample:
        return scene.moment(pose_matrix(gone[:3, :3], gone[:3, 3] + 0.2 * share * _Z), 0.08, moved)

    return [scene.approach(tool, 0.08), up, across, down, (1.0, leave)]


def _pick_clutter(scene: HeadedTrial) -> list[Phase]:
    """Lift out from among the other objects, and hold tilted."""
    tool = scene.tool(np.array([0.0, 0.0, max(0.0, scene.extent[2] / 2 - 0.03)]))
    width = min(0.08, float(scene.extent[1]))
    up, moved = scene.carry(tool, width, 2.0, 0.16 * _Z, ())
    point = moved[:3, 3] + scene.middle
    aslant, _ = scene.carry(tool, width, 2.0, -0.08 * scene.turn[:, 0], ((_Y, 0.6, point), (_Z, 0.4, point)), moved)
    return [scene.approach(tool, 0.08), up, aslant]


def _push_pick(scene: HeadedTrial) -> list[Phase]:
    """Slide under closed fingers that press from above, then grip at the far end and lift tilted."""
    press = scene.tool(np.array([-0.2 * scene.extent[0], 0.0, scene.extent[2] / 2]))
    ahead = 0.18 * scene.turn[:, 0]
    slide, moved = scene.carry(press, 0.0, 3.0, ahead, ((_Z, 0.3, scene.middle),))
    # Out of the palm points back to the robot, with the fingers astride.
    back = np.stack([_Z, -_Y, -_X], 1) @ rotation_about(_Z, math.pi / 2)
    grip = scene.tool(np.array([scene.extent[0] / 2 - 0.02, 0.0, 0.0]), back)
    start, end = moved @ press, moved @ grip

    def regrasp(share: float) -> MotionSample:
        over = 0.15 * math.sin(math.pi * share) * _Z
        orientation = start[:3, :3] if share < 0.5 else end[:3, :3]
        return scene.moment(
            pose_matrix(orientation, (1 - share) * start[:3, 3] + share * end[:3, 3] + over), 0.04, moved
        )

    point = end[:3, 3]
    lift, _ = scene.carry(
        grip, 0.02, 2.5, 0.15 * _Z, ((rotation_about(_Z, 0.3) @ scene.turn[:, 1], 0.35, point),), moved
    )
    return [scene.approach(press, 0.0), slide, (1.5, regrasp), lift]


def _flip(scene: HeadedTrial) -> list[Phase]:
    """Tilt over the far lower edge with a hand that pushes high up, until the object lies on its far side."""
    tool = scene.tool(np.array([-scene.extent[0] / 2 - 0.012, 0.0, 0.3 * scene.extent[2]]))
    edge = scene.middle + scene.turn @ np.array([scene.extent[0] / 2, 0.0, -scene.extent[2] / 2])
    over, _ = scene.carry(tool, 0.0, 3.0, np.zeros(3), ((scene.turn[:, 1], math.pi / 2, edge),), upright=True)
    return [scene.approach(tool, 0.0), over, (0.5, lambda share: over[1](1.0))]


def _flip_wall(scene: HeadedTrial) -> list[Phase]:
    """Push to the wall and then, from below the near edge, rotate up against it."""
    tool = scene.tool(np.array([-scene.extent[0] / 2 - 0.012, 0.0, 0.0]))
    walls = [f.position[0] - f.size[0] / 2 for f in scene.fixtures if f.position[0] > scene.middle[0]]
    room = min(walls, default=float(scene.middle[0] + scene.extent[0] / 2 + 0.1))
    thick = float(scene.extent[2])
    gap = max(0.02, room - float(scene.middle[0] + scene.extent[0] / 2) - 0.25 * thick)
    slide, moved = scene.carry(tool, 0.0, 2.0, gap * _X, ((_Z, -scene.heading, scene.middle),))
    middle = scene.middle + gap * _X
    edge = middle + np.array([scene.extent[0] / 2, 0.0, -scene.extent[2] / 2])
    # The foot slides back by the thickness: the former top ends up against the wall.
    up, _ = scene.carry(tool, 0.0, 3.0, -thick * _X, ((_Y, math.pi / 2, edge),), moved, True)
    return [scene.approach(tool, 0.0), slide, up, (0.5, lambda share: up[1](1.0))]


MOTIONS: dict[str, Callable[[HeadedTrial], list[Phase]]] = {
    "push-pick-board": _push_pick,
    "pick-box": _pick,
    "pick-clutter": _pick_clutter,
    "push-force": _push,
    "flip-box": _flip,
    "flip-wall": _flip_wall,
}
"""Motions by the name of their task."""
