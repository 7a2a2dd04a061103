"""Pictures of shells from near, upright and in clumps, and of floors without any: layers of drawn patches.

The painter's reefs are seen from a vehicle, and their oysters are smooth and lie apart. Real ones stand in
clumps, overgrown, in water of any colour, and other things look like them. A collage shows that for a fifth of the
work, with no depth: it teaches and tests which pixels are oysters, nothing else.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.reef.world.geometry import Label

OTHER = 4
"""Label of a pixel that shows no oyster, whatever it is."""
_SHELL_PX, _SHELLS = 128, 40
Image = NDArray[np.float32]


@dataclass(frozen=True)
class Collage:
    """A picture and where oysters are."""

    rgb: NDArray[np.uint8]
    """sRGB. Shape=(H, W, 3)."""
    target: NDArray[np.uint8]
    """`Label.OYSTER` or `OTHER`. Shape=(H, W)."""


class CollagePainter:
    """Draws collages with a stock of shells that is made once."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.shells = [draw_shell(rng) for _ in range(_SHELLS)]

    def clumps(self, size: tuple[int, int], rng: np.random.Generator) -> Collage:
        """Draw shells on a floor or as a wall, the farther ones smaller and behind. `size` is width and height (px)."""
        width, height = size
        horizon = (
            float(rng.uniform(0.0, 0.35)) * height if rng.random() < 0.5 else -float(rng.uniform(0.3, 3.0)) * height
        )
        image = _ground(size, horizon, rng)
        target = np.full((height, width), OTHER, np.uint8)
        middles = [(rng.uniform(0, width), rng.uniform(max(horizon, 0.0), height)) for _ in range(rng.integers(1, 5))]
        spread = width * float(rng.uniform(0.1, 0.6))
        largest = width * float(np.exp(rng.uniform(math.log(0.07), math.log(0.5))))
        upright, tone = rng.random() < 0.6, rng.uniform(0.35, 1.1) * _earth(rng)
        count = min(int(np.exp(rng.uniform(-1.0, 1.3)) * width * height / (0.3 * largest**2)), 400)
        places = []
        for _ in range(count):
            x, y = middles[rng.integers(len(middles))]
            places.append((rng.normal(x, spread), rng.normal(y, 0.6 * spread)))
        for x, y in sorted(places, key=lambda place: place[1]):
            nearness = (y - horizon) / (height - horizon)
            length = largest * min(nearness, 1.3) * float(np.exp(rng.normal(-0.1, 0.35)))
            if nearness <= 0.1 or length < 4.0:
                continue
            turn = float(rng.normal(0.0, 0.5)) if upright else float(rng.uniform(-math.pi, math.pi))
            lit = tone * rng.uniform(0.6, 1.35) * rng.uniform(0.95, 1.05, 3)
            self._lay(image, target, (x, y), length, turn, lit, rng)
        if rng.random() < 0.5:
            _overgrow(image, rng)
        return Collage(_develop(image, horizon, rng), target)

    def _lay(
        self,
        image: Image,
        target: NDArray[np.uint8],
        place: tuple[float, float],
        length: float,
        turn: float,
        lit: NDArray[np.float64],
        rng: np.random.Generator,
    ) -> None:
        """Draw one shell, with its shadow below."""
        colour, alpha = self.shells[rng.integers(len(self.shells))]
        scale, thin = length / _SHELL_PX, float(rng.uniform(0.35, 1.0))
        c, s, half = math.cos(turn), math.sin(turn), _SHELL_PX / 2
        turned = np.array([[thin * scale * c, -scale * s], [thin * scale * s, scale * c]])
        reach = math.ceil(0.75 * length) + 2
        x0, y0 = round(place[0]) - reach, round(place[1]) - reach
        left, top = max(x0, 0), max(y0, 0)
        right, bottom = min(x0 + 2 * reach, image.shape[1]), min(y0 + 2 * reach, image.shape[0])
        if left >= right or top >= bottom:
            return
        shift = np.array([place[0] - left, place[1] - top]) - turned @ (half, half)
        warp, size = np.hstack([turned, shift[:, None]]), (right - left, bottom - top)
        how = cv2.INTER_AREA if scale < 0.5 else cv2.INTER_LINEAR
        drawn = cv2.warpAffine(colour, warp, size, flags=how)
        cover = cv2.warpAffine(alpha, warp, size, flags=how)
        part = image[top:bottom, left:right]
        shade = cv2.GaussianBlur(cover, (0, 0), max(0.08 * length, 0.5))
        part *= 1.0 - 0.55 * shade[..., None]
        part += cover[..., None] * (drawn * lit.astype(np.float32) - part)
        target[top:bottom, left:right][cover > 0.5] = int(Label.OYSTER)


def draw_shell(rng: np.random.Generator) -> tuple[Image, Image]:
    """Draw a shell, hinge down, lit from above: colours, Shape=(S, S, 3), and coverage, Shape=(S, S)."""
    span = np.linspace(-1.0, 1.0, _SHELL_PX, dtype=np.float32)
    x, y = np.meshgrid(span, span)
    angle = np.arctan2(x, -y)
    outline = 0.86 + sum(
        float(rng.normal(0.0, 0.09 / k)) * np.cos(k * angle + float(rng.uniform(0, 6.28))) for k in range(2, 7)
    )
    outline = outline - float(rng.uniform(0.1, 0.4)) * np.clip(np.abs(angle) / math.pi, 0, 1) ** 2 * np.abs(x)
    wide = float(rng.uniform(0.55, 0.9)) * (1.0 - float(rng.uniform(0.0, 0.55)) * (y + 1.0) / 2.0)
    away = np.sqrt((x / wide) ** 2 + y**2) / outline
    hinge = np.sqrt(x**2 + (y - 0.9) ** 2) + 0.06 * _clouds((_SHELL_PX, _SHELL_PX), 6, rng)
    rings = np.sin(hinge * float(rng.uniform(18, 60)))
    ridges = np.sin(angle * float(rng.integers(4, 14)) + 3.0 * _clouds((_SHELL_PX, _SHELL_PX), 4, rng))
    bulge = np.sqrt(np.clip(1.0 - away**2, 0.0, 1.0))
    tall = 0.8 * bulge + 0.007 * rings + 0.01 * ridges + 0.05 * _clouds((_SHELL_PX, _SHELL_PX), 16, rng)
    up = cv2.Sobel(np.asarray(tall, np.float32), cv2.CV_32F, 0, 1, ksize=3) * 6.0
    light = np.clip(0.75 + 0.4 * up + 0.06 * rings + 0.3 * _clouds((_SHELL_PX, _SHELL_PX), 10, rng), 0.08, 1.5)
    stain = np.clip(1.5 * _clouds((_SHELL_PX, _SHELL_PX), 5, rng) + float(rng.uniform(-0.5, 0.4)), 0.0, 1.0)[..., None]
    pale = np.array([0.85, 0.82, 0.76]) * rng.uniform(0.6, 1.1)
    dark = np.array([0.35, 0.32, 0.2]) * rng.uniform(0.4, 1.2, 3)
    colour = light[..., None] * (pale + stain * (dark - pale))
    return colour.astype(np.float32), np.clip((1.0 - away) * 14.0, 0.0, 1.0).astype(np.float32)


def _clouds(shape: tuple[int, int], cells: int, rng: np.random.Generator, octaves: int = 3) -> Image:
    """Return noise of zero mean, about -1 to 1, whose coarsest lumps are 1 / cells of the width."""
    total = np.zeros(shape, np.float32)
    for octave in range(octaves):
        across = min(cells * 2**octave, shape[1])
        grid = rng.uniform(-1.0, 1.0, (max(2, across * shape[0] // shape[1]), across)).astype(np.float32)
        total += cv2.resize(grid, shape[::-1], interpolation=cv2.INTER_CUBIC) / np.float32(2**octave)
    return np.asarray(total / 1.3, np.float32)


def _earth(rng: np.random.Generator) -> NDArray[np.float64]:
    return np.array([1.0, rng.uniform(0.82, 1.05), rng.uniform(0.55, 1.05)])


def _ground(size: tuple[int, int], horizon: float, rng: np.random.Generator) -> Image:
    """Return a floor of silt, sand, grit or dark gaps, and water above the horizon."""
    width, height = size
    shape = (height, width)
    tone = rng.uniform(0.08, 0.7) * _earth(rng)
    grain = 0.35 * _clouds(shape, int(rng.integers(3, 9)), rng) + rng.uniform(0.05, 0.5) * _clouds(
        shape, int(rng.integers(20, 90)), rng
    )
    image = np.clip(1.0 + grain, 0.1, 2.0)[..., None] * tone
    rows = int(np.clip(horizon, 0, height))
    if rows:
        image[:rows] = rng.uniform(0.2, 0.9) * np.array([rng.uniform(0.3, 0.9), 1.0, rng.uniform(0.3, 1.1)])
    return image.astype(np.float32)


def _overgrow(image: Image, rng: np.random.Generator) -> None:
    """Cover some of a picture with algae or silt."""
    shape = image.shape[:2]
    veil = np.clip(2.5 * _clouds(shape, int(rng.integers(3, 12)), rng) - rng.uniform(0.2, 1.2), 0.0, 0.85)[..., None]
    colour = np.array([(0.2, 0.35, 0.08), (0.3, 0.2, 0.1), (0.5, 0.45, 0.3), (0.1, 0.1, 0.05)][rng.integers(4)])
    fibre = 1.0 + 0.4 * _clouds(shape, 70, rng, 2)[..., None]
    image += veil.astype(np.float32) * ((colour * fibre).astype(np.float32) - image)


def _develop(image: Image, horizon: float, rng: np.random.Generator) -> NDArray[np.uint8]:
    """Put water between the camera and a picture: veil and loss of colour grow towards the horizon."""
    height, width = image.shape[:2]
    low = np.clip((np.arange(height) - horizon) / max(height - horizon, 1.0), 0.03, 1.0)[:, None, None]
    through = np.exp(-rng.uniform(0.0, 0.5) / low) if rng.random() < 0.6 else np.ones_like(low)
    veil = np.array(
        [(0.35, 0.5, 0.25), (0.1, 0.35, 0.45), (0.45, 0.4, 0.2), (0.15, 0.15, 0.3), (0.05, 0.05, 0.05)][rng.integers(5)]
    ) * rng.uniform(0.5, 1.5)
    mixed = image * through + veil * (1.0 - through)
    mixed = mixed * (1.0 + 0.3 * _clouds((height, width), 2, rng, 1)[..., None])
    soft = cv2.GaussianBlur(np.clip(mixed, 0.0, 1.0).astype(np.float32), (0, 0), float(rng.uniform(0.4, 1.6)))
    return np.asarray(np.clip(255.0 * soft, 0, 255), np.uint8)


def _stones(image: Image, horizon: float, largest: float, rng: np.random.Generator) -> None:
    height, width = image.shape[:2]
    for y in np.sort(rng.uniform(max(horizon, 0.0), 1.1 * height, int(rng.integers(80, 300)))):
        near = (y - horizon) / (height - horizon)
        long = largest * near * float(np.exp(rng.normal(0.0, 0.4)))
        if long < 2.0:
            continue
        tone = rng.uniform(0.15, 0.7) * rng.uniform(0.85, 1.15, 3)
        centre, turn = (int(rng.uniform(0, width)), int(y)), float(rng.uniform(0, 180))
        flat = rng.uniform(0.6, 0.95)
        for k in range(4):  # smooth and round, lit from above
            part = 1.0 - 0.24 * k
            at = (centre[0], int(centre[1] - 0.1 * k * long))
            axes = (max(int(0.5 * part * long), 1), max(int(0.5 * part * long * flat), 1))
            cv2.ellipse(
                image, at, axes, turn, 0, 360, tuple(float(v) for v in tone * (0.7 + 0.13 * k)), -1, cv2.LINE_AA
            )


def _blades(image: Image, count: int, widest: float, tone: NDArray[np.float64], rng: np.random.Generator) -> None:
    height, width = image.shape[:2]
    for _ in range(count):
        foot, top = rng.uniform(0, width), rng.uniform(-0.2, 0.7) * height
        way = np.linspace(0.0, 1.0, 12)
        sway = foot + rng.normal(0, 0.25 * width) * way**2 + 0.04 * width * np.sin(way * rng.uniform(3, 9))
        line = np.stack([sway, height * 1.02 + (top - height) * way], axis=1).astype(np.int32)
        colour = tuple(float(v) for v in tone * rng.uniform(0.4, 1.4))
        cv2.polylines(
            image, [line.reshape(-1, 1, 2)], False, colour, max(int(rng.uniform(0.3, 1.0) * widest), 1), cv2.LINE_AA
        )


def _sand(image: Image, horizon: float, rng: np.random.Generator) -> None:
    height, width = image.shape[:2]
    y = np.arange(height)[:, None] - horizon
    phase = rng.uniform(200, 900) * np.log(np.maximum(y, 1.0)) / 10.0 + 3.0 * _clouds((height, width), 5, rng)
    image *= (1.0 + rng.uniform(0.05, 0.3) * np.sin(phase) * (y > 0))[..., None].astype(np.float32)


def _grass(image: Image, horizon: float, rng: np.random.Generator) -> None:
    _blades(image, int(rng.integers(80, 300)), 4.0, np.array([0.25, 0.5, 0.15]), rng)


def _cobbles(image: Image, horizon: float, rng: np.random.Generator) -> None:
    _stones(image, horizon, image.shape[1] * float(rng.uniform(0.05, 0.3)), rng)


def _tank(image: Image, horizon: float, rng: np.random.Generator) -> None:
    height, width = image.shape[:2]
    image[:] = rng.uniform(0.3, 0.9) * np.array([0.75, 0.95, 1.0])
    step, slant = int(rng.uniform(0.06, 0.25) * width), int(rng.normal(0, 0.2) * width)
    for k in range(-2, width // step + 3):
        cv2.line(image, (k * step, 0), (k * step + slant, height), (0.3, 0.4, 0.45), 2, cv2.LINE_AA)
        cv2.line(image, (0, k * step), (width, k * step - slant // 3), (0.3, 0.4, 0.45), 2, cv2.LINE_AA)


BARE: dict[str, Callable[[Image, float, np.random.Generator], None]] = {
    "sand": _sand, "cobbles": _cobbles, "seagrass": _grass, "tank": _tank,
}  # fmt: skip
"""Floors without oysters, by name."""


def bare_picture(kind: str, size: tuple[int, int], rng: np.random.Generator) -> Collage:
    """Draw a picture without oysters. `kind` is one of `BARE`; `size` is width and height (px)."""
    width, height = size
    # As often high above the picture: a floor seen from above.
    horizon = height * float(rng.uniform(0.0, 0.35) if rng.random() < 0.5 else -rng.uniform(0.3, 3.0))
    image = _ground(size, horizon, rng)
    BARE[kind](image, horizon, rng)
    if rng.random() < 0.3:
        _overgrow(image, rng)
    return Collage(_develop(image, horizon, rng), np.full((height, width), OTHER, np.uint8))
