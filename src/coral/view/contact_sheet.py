"""A contact sheet: several pictures side by side, each with its title."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from coral.drawing import Image, draw_text

_TITLE_PX, _GAP_PX = 26, 6
_INK, _PAPER = (30, 34, 42), 250


def contact_sheet(pictures: Sequence[tuple[str, Image]], columns: int) -> Image:
    """Lay pictures of one size, Shape=(h, w, 3) RGB each, out in rows, below their titles. Shape=(H, W, 3)."""
    height, width = pictures[0][1].shape[:2]
    rows = -(-len(pictures) // columns)
    across, down = width + _GAP_PX, height + _TITLE_PX + _GAP_PX
    sheet = np.full((rows * down + _GAP_PX, columns * across + _GAP_PX, 3), _PAPER, np.uint8)
    for k, (title, picture) in enumerate(pictures):
        left, top = k % columns * across + _GAP_PX, k // columns * down + _GAP_PX
        draw_text(sheet, title, left + 2, top + _TITLE_PX // 2, size=15, color=_INK, weight=600)
        sheet[top + _TITLE_PX : top + _TITLE_PX + height, left : left + width] = picture
    return sheet
