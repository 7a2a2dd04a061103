"""The best colour picture of each cluster on one sheet."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.drawing import Image, draw_text
from coral.reef.map.belief import Belief
from coral.reef.map.best_views import HALF_M

TILE_PX, COLUMNS, MOST = 240, 4, 12
"""Edge of a tile, tiles in a row, and most tiles: those of the clusters that lie nearest."""
BAR_PX = round(TILE_PX * 0.5 / (2.0 * HALF_M))
"""Half a metre in a tile, which is `2 HALF_M` wide where the crop is whole."""
MOST_GAIN, MOST_TINT = 5.0, 2.0
"""Contrast is stretched by no more than this, and that of one colour by no more than this over another: what far water
leaves of red is noise."""


def things_picture(belief: Belief) -> Image | None:
    """Draw the sheet; None if no cluster has been in view. Shape=(H, W, 3) RGB."""
    found = belief.best_views.of(belief.tracks)
    found.sort(key=lambda each: math.dist((each[0].x, each[0].y), belief.pose[:2]))
    tiles = [
        _tile(view.crop, f"{track.index}: {view.distance_m:.1f} m, {age_s:.0f} s ago")
        for track, view, age_s in sorted(found[:MOST], key=lambda each: each[0].index)
    ]
    if not tiles:
        return None
    tiles += [np.zeros_like(tiles[0])] * (-len(tiles) % min(COLUMNS, len(tiles)))
    width = min(COLUMNS, len(tiles))
    return np.concatenate([np.concatenate(tiles[k : k + width], 1) for k in range(0, len(tiles), width)], 0)


def _tile(crop: NDArray[np.uint8], words: str) -> Image:
    height, width = crop.shape[:2]
    scale = TILE_PX / max(height, width)
    size = max(1, round(width * scale)), max(1, round(height * scale))
    tile = np.zeros((TILE_PX, TILE_PX, 3), np.uint8)
    tile[: size[1], : size[0]] = cv2.resize(stretched(crop), size, interpolation=cv2.INTER_AREA)
    tile[-8:-5, 6 : 6 + BAR_PX] = 255
    tile[:20] //= 3
    draw_text(tile, words, 5, 10, size=14, color=(255, 255, 255), anchor="lm")
    return tile


def stretched(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Stretch the contrast of each colour, as an operator does with a murky picture."""
    low, high = np.percentile(picture, (1.0, 99.0), axis=(0, 1))
    gain = np.minimum(235.0 / np.maximum(high - low, 1.0), MOST_GAIN)
    gain = np.minimum(gain, MOST_TINT * gain.min())
    middle = 0.5 * (low + high)
    grown = (picture - middle) * gain + np.clip(middle, 0.5 * 235.0 * 0.8, 150.0)
    return np.asarray(np.clip(grown, 0, 255), np.uint8)
