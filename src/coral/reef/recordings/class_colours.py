"""Colours that stand for classes where people look at them."""

from __future__ import annotations

from coral.reef.world.geometry import Label

CLASS_COLOURS = {
    Label.WATER: (20, 60, 90),
    Label.OYSTER: (64, 160, 92),
    Label.OBSTACLE: (70, 72, 78),
    Label.SEABED: (205, 188, 150),
}
"""Red, green, blue."""
