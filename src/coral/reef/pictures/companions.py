"""The other robots of a mission on a map picture: positions, tracks and goals."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.drawing import RGB, draw_arrow, draw_dot, draw_line, draw_text, text_size
from coral.reef.pictures.mapframe import RED, YELLOW, MapPicture
from coral.reef.world.geometry import Pose

PURPLE: RGB = (126, 58, 200)
"""Colour of every other robot in the pictures for an advisor."""
COLORS: tuple[RGB, ...] = (RED, PURPLE, (0, 150, 170), (140, 80, 25))
"""Colours of robots 0 to 3 in pictures for people; the first one's track is yellow, as in the paper."""
WHITE: RGB = (255, 255, 255)


@dataclass(frozen=True, kw_only=True)
class Companion:
    """Another robot; world frame, metres."""

    pose: Pose | None
    goal: tuple[float, float] | None = None
    trajectory: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2)))
    """Shape=(N, 2), oldest first."""
    color: RGB = PURPLE


def draw_tracks(view: MapPicture, companions: tuple[Companion, ...]) -> None:
    """Draw the tracks of the other robots, in place, under everything else."""
    for one in companions:
        draw_line(view.rgb, view.to_pixels(one.trajectory.reshape(-1, 2)), one.color, 3, edge=WHITE)


def draw_companions(view: MapPicture, companions: tuple[Companion, ...]) -> None:
    """Draw the other robots with their headings, and a ring around the goal of each, in place."""
    for one in companions:
        if one.goal is not None:
            x, y = (round(float(v)) for v in view.to_pixels(np.array(one.goal)))
            cv2.circle(view.rgb, (x, y), 11, WHITE, 5, cv2.LINE_AA)
            cv2.circle(view.rgb, (x, y), 11, one.color, 3, cv2.LINE_AA)
        if one.pose is not None:
            at = view.to_pixels(np.array(one.pose[:2]))
            draw_arrow(
                view.rgb, at, at + 40 * np.array([math.cos(one.pose.theta), -math.sin(one.pose.theta)]), one.color
            )
            draw_dot(view.rgb, at, 8.0, one.color)


def draw_key(view: MapPicture, companions: tuple[Companion, ...]) -> None:
    """Draw the key of robot colours in the upper right corner, in place."""
    entries = [(YELLOW, "robot 0"), *((one.color, f"robot {k}") for k, one in enumerate(companions, 1))]
    width = max(text_size(name, 14, 600)[0] for _, name in entries) + 40
    left = view.rgb.shape[1] - width
    box = view.rgb[4 : 12 + 20 * len(entries), left:-4]
    box[:] = np.rint(0.15 * box + 0.85 * 255).astype(np.uint8)
    for row, (color, name) in enumerate(entries):
        y = 18.0 + 20 * row
        draw_line(view.rgb, np.array([(left + 6.0, y), (left + 26.0, y)]), color, 4)
        draw_text(view.rgb, name, left + 33, y, size=14, weight=600, anchor="lm")
