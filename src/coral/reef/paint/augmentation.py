"""Varies pictures of a batch as cameras, lights and waters would. Needs torch; runs where the tensors are."""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor
from torch.nn import functional

from coral.reef.eyes.ground_plane import NEAR_PER_M


@dataclass(frozen=True)
class PictureWindow:
    """The part of each picture that is looked at: an affine map from the new picture to the old one."""

    matrix: Tensor
    """In coordinates from -1 to 1. Shape=(N, 2, 3)."""
    share: Tensor
    """Width of the window as a share of the picture's. Shape=(N,)."""


class BatchRandom:
    """Random numbers on the device of a batch."""

    def __init__(self, seed: int, device: torch.device) -> None:
        self.generator = torch.Generator(device=device).manual_seed(seed)
        self.device = device

    def uniform(self, low: float, high: float, *shape: int) -> Tensor:
        """Draw evenly from low to high."""
        return low + (high - low) * torch.rand(shape, device=self.device, generator=self.generator)

    def normal(self, scale: float, *shape: int) -> Tensor:
        """Draw from a normal distribution around 0."""
        return scale * torch.randn(shape, device=self.device, generator=self.generator)

    def often(self, share: float, count: int) -> Tensor:
        """Draw which of some pictures are meant, as 0 or 1. Shape=(count, 1, 1, 1)."""
        return (self.uniform(0.0, 1.0, count, 1, 1, 1) < share).float()


def choose_windows(count: int, chance: BatchRandom, *, scale: tuple[float, float], turned: bool) -> PictureWindow:
    """Choose windows, half of them mirrored; `turned`: some are also turned and squashed.

    `scale` is the least and largest share of the picture; above 1 the picture repeats, mirrored, beyond its edges.
    """
    share = torch.exp(chance.uniform(math.log(scale[0]), math.log(scale[1]), count))
    squash = torch.exp(0.5 * chance.uniform(-0.45, 0.45, count)) if turned else torch.ones_like(share)
    wide, tall = share * squash, share / squash
    little, much = chance.normal(0.12, count), chance.uniform(-math.pi, math.pi, count)
    angle = torch.where(chance.uniform(0.0, 1.0, count) < 0.15, much, little) * float(turned)
    mirror = torch.where(chance.uniform(0.0, 1.0, count) < 0.5, -1.0, 1.0)
    shift = (1.0 - share).abs()[:, None] * chance.uniform(-1.0, 1.0, count, 2)
    c, s = torch.cos(angle), torch.sin(angle)
    matrix = torch.stack(
        [
            torch.stack([mirror * wide * c, -tall * s, shift[:, 0]], dim=1),
            torch.stack([mirror * wide * s, tall * c, shift[:, 1]], dim=1),
        ],
        dim=1,
    )
    return PictureWindow(matrix, share)


def look_through(image: Tensor, window: PictureWindow, size: tuple[int, int], mode: str) -> Tensor:
    """Resample pictures, Shape (N, C, H, W), to a size (height, width).

    `mode` is bilinear (colours, which are smoothed where they shrink) or nearest.
    """
    grid = functional.affine_grid(window.matrix, [len(image), image.shape[1], *size], align_corners=False)
    seen = functional.grid_sample(image, grid, mode, "reflection", align_corners=False)
    for level in (2, 4) if mode == "bilinear" else ():
        if 1.6 * image.shape[3] / size[1] > 0.75 * level:  # not asked of the pictures: a graphics card would wait
            shrinks = window.share * image.shape[3] / size[1] > 0.75 * level
            small = functional.avg_pool2d(image, level)
            coarse = functional.grid_sample(small, grid, mode, "reflection", align_corners=False)
            seen = torch.where(shrinks[:, None, None, None], coarse, seen)
    return seen


def vary_colours(light: Tensor, depth: Tensor | None, chance: BatchRandom, strength: float = 1.0) -> Tensor:
    """Change gains, gamma, saturation of sRGB, 0 to 1, Shape (N, 3, H, W); add haze, a lamp, blur and noise.

    The haze follows the depth, Shape (N, 1, H, W), inf for none; None: it is thicker towards the top. `strength` is of
    gains, mixing and haze.
    """
    n = len(light)
    mixing = torch.eye(3, device=light.device) + chance.normal(0.08 * strength, n, 3, 3)
    light = torch.einsum("nij,njhw->nihw", mixing, light)
    light = light * torch.exp(chance.normal(0.25 * strength, n, 3, 1, 1) + chance.normal(0.25, n, 1, 1, 1))
    light = light.clamp(1e-4, 1.0) ** torch.exp(chance.normal(0.25, n, 1, 1, 1))
    gray = light.mean(dim=1, keepdim=True)
    light = gray + (light - gray) * (1.0 - chance.often(0.4, n) * chance.uniform(-0.4, 1.0, n, 1, 1, 1))
    light = _hazed(light, depth, chance, strength)
    light = _lit(light, chance)
    light = _blurred(light, chance)
    return (light + chance.normal(1.0, *light.shape) * chance.uniform(0.0, 0.035, n, 1, 1, 1)).clamp(0.0, 1.0)


def _clouds(count: int, size: tuple[int, int], cells: int, chance: BatchRandom) -> Tensor:
    grid = chance.uniform(0.0, 1.0, count, 1, cells, cells)
    return functional.interpolate(grid, size=size, mode="bilinear", align_corners=False)


def _hazed(light: Tensor, depth: Tensor | None, chance: BatchRandom, strength: float) -> Tensor:
    n, size = len(light), (light.shape[2], light.shape[3])
    if depth is None:
        rows = torch.linspace(1.0, 0.0, size[0], device=light.device)[None, None, :, None]
        upwards = chance.often(0.6, n)
        away = (1.0 - upwards) + upwards * 2.0 * rows ** chance.uniform(0.5, 3.0, n, 1, 1, 1)
        away = away * (0.5 + _clouds(n, size, 4, chance))
    else:
        away = depth.clamp(max=12.0) / 3.0
    through = torch.exp(-chance.often(0.5, n) * strength * chance.uniform(0.0, 1.2, n, 1, 1, 1) * away)
    veil = chance.uniform(0.0, 0.9, n, 3, 1, 1)
    green = torch.stack([torch.full((1, 1), v, device=light.device) for v in (0.5, 0.65, 0.25)]) * chance.uniform(
        0.3, 1.3, n, 1, 1, 1
    )
    veil = torch.where(chance.often(0.5, n) > 0, green, veil)
    return through * light + (1.0 - through) * veil


def _lit(light: Tensor, chance: BatchRandom) -> Tensor:
    n = len(light)
    y = torch.linspace(-1.0, 1.0, light.shape[2], device=light.device)[None, None, :, None]
    x = torch.linspace(-1.0, 1.0, light.shape[3], device=light.device)[None, None, None, :]
    r2 = (x - chance.normal(0.5, n, 1, 1, 1)) ** 2 + (y - chance.normal(0.5, n, 1, 1, 1)) ** 2
    return light * torch.exp(-chance.often(0.3, n) * chance.uniform(0.0, 1.5, n, 1, 1, 1) * r2)


def _blurred(light: Tensor, chance: BatchRandom) -> Tensor:
    n, size = len(light), (light.shape[2], light.shape[3])
    sigma = chance.uniform(0.4, 2.0, 1)
    taps = torch.arange(-4, 5, device=light.device, dtype=light.dtype)
    kernel = torch.exp(-0.5 * (taps / sigma) ** 2)
    kernel = kernel / kernel.sum()
    three = light.shape[1]
    across = kernel.expand(three, 1, 1, 9).contiguous()
    soft = functional.conv2d(functional.pad(light, (4, 4, 4, 4), "replicate"), across, groups=three)
    moved = soft[:, :, 4:-4]  # along rows only: the camera moves sideways
    soft = functional.conv2d(soft, across.transpose(2, 3).contiguous(), groups=three)
    half = functional.interpolate(functional.avg_pool2d(light, 2), size=size, mode="bilinear", align_corners=False)
    which = chance.uniform(0.0, 1.0, n, 1, 1, 1)
    light = torch.where(which < 0.25, soft, light)
    light = torch.where((which >= 0.25) & (which < 0.35), moved, light)
    return torch.where((which >= 0.35) & (which < 0.5), half, light)


def random_floor(count: int, size: tuple[int, int], chance: BatchRandom) -> Tensor:
    """Return the inverse depth of a flat floor below cameras at random, as nobody knows the real ones (N, 1, H, W)."""
    height, width = size
    focal = 0.5 * width / torch.tan(0.5 * torch.deg2rad(chance.uniform(40.0, 120.0, count, 1, 1)))
    q = (torch.arange(height, device=chance.device)[None, :, None] - 0.5 * (height - 1)) / focal
    p = (torch.arange(width, device=chance.device)[None, None, :] - 0.5 * (width - 1)) / focal
    pitch = torch.deg2rad(chance.uniform(-20.0, 90.0, count, 1, 1))
    falling = torch.sin(pitch) + q * torch.cos(pitch) + p * chance.normal(0.05, count, 1, 1)
    usual = (torch.sin(torch.deg2rad(torch.tensor(15.0))) + q * torch.cos(torch.deg2rad(torch.tensor(15.0)))) + 0.0 * p
    falling = torch.where(chance.uniform(0.0, 1.0, count, 1, 1) < 0.3, usual, falling)
    altitude = chance.uniform(0.3, 2.0, count, 1, 1)
    return (falling / altitude).clamp(0.0, NEAR_PER_M)[:, None]


def paste_titles(light: Tensor, titles: Tensor, chance: BatchRandom, share: float = 0.12) -> Tensor:
    """Write titles, coverage by letters and by their box, Shape (K, 2, h, w), over a share of pictures (N, 3, H, W)."""
    n = len(light)
    which = torch.randint(len(titles), (n,), device=light.device, generator=chance.generator)
    cover = functional.interpolate(titles[which], size=light.shape[2:], mode="bilinear", align_corners=False)
    meant = chance.often(share, n)
    box = meant * chance.often(0.5, n) * cover[:, 1:]
    light = light * (1.0 - box) + box * chance.uniform(0.0, 1.0, n, 3, 1, 1)
    letters = meant * cover[:, :1]
    return light * (1.0 - letters) + letters * chance.uniform(0.7, 1.0, n, 1, 1, 1)
