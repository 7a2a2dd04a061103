"""Polygons on the ground plane: containment, and whether an outline crosses itself."""

from __future__ import annotations

from collections.abc import Sequence

Corner = tuple[float, float]


def contains_point(ring: Sequence[Corner], x: float, y: float) -> bool:
    """Check whether a point lies inside an outline, by the even-odd rule; corners in order, not repeated at the end."""
    inside = False
    for (ax, ay), (bx, by) in _edges(ring):
        if (ay > y) != (by > y) and x < ax + (y - ay) / (by - ay) * (bx - ax):
            inside = not inside
    return inside


def is_simple(ring: Sequence[Corner]) -> bool:
    """Check whether an outline has an area and no two of its edges that are not neighbours touch."""
    edges = list(_edges(ring))
    area = sum(ax * by - bx * ay for (ax, ay), (bx, by) in edges)
    if abs(area) < 1e-9:
        return False
    count = len(edges)
    return not any(
        _cross(edges[i], edges[j]) for i in range(count) for j in range(i + 2, count) if not (i == 0 and j == count - 1)
    )


def _edges(ring: Sequence[Corner]) -> zip[tuple[Corner, Corner]]:
    return zip(ring, [*ring[1:], ring[0]], strict=True)


def _cross(first: tuple[Corner, Corner], second: tuple[Corner, Corner]) -> bool:
    (a, b), (c, d) = first, second
    return _side(a, b, c) * _side(a, b, d) <= 0 and _side(c, d, a) * _side(c, d, b) <= 0


def _side(a: Corner, b: Corner, point: Corner) -> int:
    turn = (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0])
    return (turn > 1e-12) - (turn < -1e-12)
