"""Small drawing primitives on RGB pictures: text with a halo, outlined lines, PNG bytes and data addresses."""

from __future__ import annotations

import io
from base64 import b64encode
from collections.abc import Sequence
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.odd_text import printable

RGB = tuple[int, int, int]
Image = NDArray[np.uint8]

LONGEST = 200
"""Maximum characters of one text. OpenCV ends the process over half a letter, so text is made printable too."""

TITLE_PX, GAP_PX = 26, 6
"""Height of a title on a contact sheet, and the room between its pictures."""

_SUBPIXEL = 4
"""Fractional bits of the coordinates for OpenCV's anti-aliased drawing."""


def png(rgb: Image | NDArray[np.uint16]) -> bytes:
    """Encode a picture as PNG. Shape=(H, W, 3) RGB, (H, W, 4) RGBA or (H, W) grey, uint8 or uint16."""
    stored = rgb[..., [2, 1, 0, *range(3, rgb.shape[2])]] if rgb.ndim == 3 else rgb
    done, data = cv2.imencode(".png", stored, [cv2.IMWRITE_PNG_COMPRESSION, 4])
    if not done:
        raise ValueError(f"cannot encode a picture of shape {rgb.shape} and type {rgb.dtype}")
    return bytes(data)


def jpeg(rgb: Image) -> bytes:
    """Encode a colour picture as JPEG. Shape=(H, W, 3) RGB."""
    done, data = cv2.imencode(".jpg", rgb[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 92])
    if not done:
        raise ValueError(f"cannot encode a picture of shape {rgb.shape} and type {rgb.dtype}")
    return bytes(data)


def palette_png(classes: Image, palette: NDArray[np.uint8]) -> bytes:
    """Encode indices into a palette, row 0 on top, as an indexed PNG, a few kilobytes for a whole map.

    Shape=(H, W) uint8; the palette has Shape=(C, 3) RGB, C <= 256.
    """
    import PIL.Image

    picture = PIL.Image.fromarray(np.ascontiguousarray(classes), "P")
    picture.putpalette(palette.astype(np.uint8).tobytes())
    data = io.BytesIO()
    picture.save(data, "PNG")
    return data.getvalue()


def png_url(data: bytes) -> str:
    """Return a PNG as an address that holds it."""
    return "data:image/png;base64," + b64encode(data).decode()


def webp_url(rgb: Image, quality: int = 82) -> str:
    """Return a picture, Shape=(H, W, 3) RGB, as an address that holds it as WebP."""
    data = cv2.imencode(".webp", rgb[..., ::-1], [cv2.IMWRITE_WEBP_QUALITY, quality])[1]
    return "data:image/webp;base64," + b64encode(data.tobytes()).decode()


@lru_cache(maxsize=1)
def _font() -> cv2.FontFace:
    return cv2.FontFace("sans")


@lru_cache(maxsize=512)
def _sprite(text: str, size: int, weight: int, halo: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the opacity of the letters and of the halo around them, both Shape=(h, w) in [0, 1]."""
    canvas = np.zeros((3 * size, size * (len(text) + 3), 3), np.uint8)
    cv2.putText(canvas, text, (size, 2 * size), (255, 255, 255), _font(), size, weight)
    letters: Image = canvas[..., 0]
    spread: Image = letters
    if halo:
        disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * halo + 1, 2 * halo + 1))
        spread = np.asarray(cv2.dilate(letters, disc), np.uint8)
    rows, columns = np.nonzero(spread.any(axis=1))[0], np.nonzero(spread.any(axis=0))[0]
    if not rows.size:
        return np.zeros((size, 1), np.float32), np.zeros((size, 1), np.float32)
    # Vertical extent from the font size, not from the letters, so that neighbouring words share a baseline.
    box = slice(size, 2 * size + size // 2), slice(columns[0], columns[-1] + 1)
    opacity = np.asarray([letters[box], spread[box]], np.float32) / np.float32(255)
    return opacity[0].astype(np.float32), opacity[1].astype(np.float32)


def text_size(text: str, size: int, weight: int = 500, halo: int = 0) -> tuple[int, int]:
    """Return the width and height (px) of a text drawn by `draw_text`."""
    height, width = _sprite(printable(text, LONGEST), size, weight, halo)[0].shape
    return width, height


def draw_text(
    image: Image,
    text: str,
    x: float,
    y: float,
    *,
    size: int = 14,
    color: RGB = (40, 44, 52),
    weight: int = 500,
    halo: int = 0,
    anchor: str = "lm",
) -> None:
    """Write one line in place, Shape=(H, W, 3) RGB, moved if necessary so that it stays inside the picture.

    Characters that cannot be shown, and those beyond the maximum, are replaced. `anchor`: first letter l/m/r: text
    starts at, is centred on, ends at x; second t/m/b likewise for y. Letters have a height `size` (px) and a weight
    from 400, regular, to 800, bold; the white `halo` around them (px) makes them read on any ground.
    """
    letters, spread = _sprite(printable(text, LONGEST), size, weight, halo)
    h, w = letters.shape
    left = round(x - {"l": 0.0, "m": 0.5, "r": 1.0}[anchor[0]] * w)
    top = round(y - {"t": 0.0, "m": 0.5, "b": 1.0}[anchor[1]] * h)
    left, top = max(0, min(left, image.shape[1] - w)), max(0, min(top, image.shape[0] - h))
    patch = image[top : top + h, left : left + w]
    letters, spread = (part[: patch.shape[0], : patch.shape[1], None] for part in (letters, spread))
    mixed: NDArray[np.float32] = patch * (1 - spread) + 255 * spread if halo else patch.astype(np.float32)
    patch[:] = np.rint(mixed * (1 - letters) + np.array(color, np.float32) * letters).astype(np.uint8)


def fixed_point(points: NDArray[np.float64]) -> NDArray[np.int32]:
    """Convert pixel coordinates to the fixed-point integers of OpenCV's `shift` argument. Shape=(N, 1, 2)."""
    return np.rint(np.asarray(points, np.float64).reshape(-1, 1, 2) * (1 << _SUBPIXEL)).astype(np.int32)


def draw_line(image: Image, points: NDArray[np.float64], color: RGB, width: int = 2, edge: RGB | None = None) -> None:
    """Draw an anti-aliased polyline in place through `points`, Shape=(N, 2) px, with an optional edge."""
    if len(points) < 2:
        return
    line = [fixed_point(points)]
    if edge is not None:
        cv2.polylines(image, line, False, edge, width + 2, cv2.LINE_AA, _SUBPIXEL)
    cv2.polylines(image, line, False, color, width, cv2.LINE_AA, _SUBPIXEL)


def draw_dot(
    image: Image,
    center: NDArray[np.float64],
    radius: float,
    color: RGB,
    edge: RGB = (255, 255, 255),
    edge_width: float = 2.0,
) -> None:
    """Draw a filled disc in place with an edge; `center` (x, y) px."""
    x, y = (int(value) for value in fixed_point(center).reshape(2))
    scale = 1 << _SUBPIXEL
    cv2.circle(image, (x, y), round((radius + edge_width) * scale), edge, -1, cv2.LINE_AA, _SUBPIXEL)
    cv2.circle(image, (x, y), round(radius * scale), color, -1, cv2.LINE_AA, _SUBPIXEL)


def draw_arrow(image: Image, start: NDArray[np.float64], end: NDArray[np.float64], color: RGB, width: int = 3) -> None:
    """Draw an arrow in place with a white edge; ends are (x, y) px."""
    along = end - start
    length = float(np.hypot(*along))
    if length < 1e-6:
        return
    along = along / length
    across = np.array([-along[1], along[0]])
    head = min(13.0, 0.5 * length)
    neck = end - head * along
    tip = np.array([end, neck + 0.5 * head * across, neck - 0.5 * head * across])
    draw_line(image, np.array([start, neck]), color, width, edge=(255, 255, 255))
    cv2.polylines(image, [fixed_point(tip)], True, (255, 255, 255), 3, cv2.LINE_AA, _SUBPIXEL)
    cv2.fillPoly(image, [fixed_point(tip)], color, cv2.LINE_AA, _SUBPIXEL)


def contact_sheet(pictures: Sequence[tuple[str, Image]], columns: int) -> Image:
    """Lay pictures of one size, Shape=(h, w, 3) RGB each, out in rows, below their titles. Shape=(H, W, 3)."""
    height, width = pictures[0][1].shape[:2]
    rows = -(-len(pictures) // columns)
    across, down = width + GAP_PX, height + TITLE_PX + GAP_PX
    sheet = np.full((rows * down + GAP_PX, columns * across + GAP_PX, 3), 250, np.uint8)
    for k, (title, picture) in enumerate(pictures):
        left, top = k % columns * across + GAP_PX, k // columns * down + GAP_PX
        draw_text(sheet, title, left + 2, top + TITLE_PX // 2, size=15, color=(30, 34, 42), weight=600)
        sheet[top + TITLE_PX : top + TITLE_PX + height, left : left + width] = picture
    return sheet
