"""Two maps of one area into one: what a new dive has seen, put onto the map of an earlier one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.reef.map.mapping_kernels import SATURATED
from coral.reef.sea.local_frame import LocalFrame, shift_points

COUNTS: tuple[str, ...] = ("_targets", "_obstacles", "_ground")
MARKS: tuple[str, ...] = ("explored", "unseeable")


def merge_maps(
    saved: Mapping[str, NDArray[Any]],
    new: Mapping[str, NDArray[Any]],
    shift: LocalFrame,
    cell_m: float,
    forbidden: NDArray[np.bool_],
) -> dict[str, NDArray[Any]]:
    """Put a new map's evidence onto a saved one. Hints of oysters far away are those of the saved map.

    Args:
        saved: `OccupancyMap.memory` of the map that stays.
        new: That of the map that is moved, of the same size.
        shift: From the new map's frame to that of the saved one.
        cell_m: Edge of a cell (m).
        forbidden: Cells that were closed on the new map, which are no evidence. Shape=(NY, NX).

    Returns:
        The memory of both. Counts of pictures are added up, in the nearest cell.
    """
    merged = {name: array.copy() for name, array in saved.items()}
    known = np.asarray(new["explored"]) & ~forbidden
    for name in COUNTS:
        known |= (np.asarray(new[name]) > 0) & ~forbidden
    if not known.any():
        return merged
    at, source = _counterparts(known, shift, cell_m)
    for name in COUNTS:
        total = merged[name][at].astype(np.int64) + new[name][source]
        merged[name][at] = np.minimum(total, SATURATED).astype(merged[name].dtype)
    for name in MARKS:
        merged[name][at] |= new[name][source]
    merged["nearest"][at] = np.minimum(merged["nearest"][at], new["nearest"][source])
    return merged


def _counterparts(
    known: NDArray[np.bool_], shift: LocalFrame, cell_m: float
) -> tuple[tuple[NDArray[np.intp], NDArray[np.intp]], tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """Return (iy, ix) of the saved map's cells that lie on known cells of the new one, and of the latter."""
    ny, nx = known.shape
    corners = np.argwhere(known)
    (y0, x0), (y1, x1) = corners.min(axis=0), corners.max(axis=0) + 1
    box = shift_points(shift, np.array([(x, y) for x in (x0, x1) for y in (y0, y1)]) * cell_m) / cell_m
    low = np.maximum(np.floor(box.min(axis=0)).astype(int), 0)
    high = np.minimum(np.ceil(box.max(axis=0)).astype(int), (nx, ny))
    ix, iy = (each.ravel() for each in np.meshgrid(np.arange(low[0], high[0]), np.arange(low[1], high[1])))
    back = shift_points(shift.inverse(), (np.stack([ix, iy], axis=1) + 0.5) * cell_m) / cell_m
    jx, jy = np.floor(back).astype(np.intp).T
    inside = (jx >= 0) & (jx < nx) & (jy >= 0) & (jy < ny)
    ix, iy, jx, jy = ix[inside], iy[inside], jx[inside], jy[inside]
    seen = known[jy, jx]
    return (iy[seen], ix[seen]), (jy[seen], jx[seen])
