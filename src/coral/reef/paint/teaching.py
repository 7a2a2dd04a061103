"""What a network is taught: painted reefs, collages, and real pictures with oysters marked."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.reef.paint.collage import BARE, CollagePainter, bare_picture
from coral.reef.paint.labelled_pictures import LabelledPicture
from coral.reef.paint.training_set import make_samples

_REAL_PX = 480
"""Edge of real pictures in memory: more than the network reads, so that a part of one is still sharp."""
_REEFS_AT_A_TIME = 5
_SHARES = {"real": 0.5, "clumps": 0.14, "bare": 0.06}
"""Shares of a batch; painted reefs are the rest."""


@dataclass(frozen=True)
class PaintedReefs:
    """N pictures of painted reefs with what is true of them."""

    rgb: NDArray[np.uint8]
    """Shape=(N, H, W, 3)."""
    floor: NDArray[np.float16]
    """Inverse depth of a flat floor (1/m). Shape=(N, H, W)."""
    labels: NDArray[np.uint8]
    """Shape=(N, H, W)."""
    depth: NDArray[np.float16]
    """Metres, inf for water. Shape=(N, H, W)."""


@dataclass(frozen=True)
class MarkedPictures:
    """N pictures of one size with oysters marked."""

    rgb: NDArray[np.uint8]
    """Shape=(N, H, W, 3)."""
    target: NDArray[np.uint8]
    """`Label.OYSTER`, `OTHER` or `UNKNOWN`. Shape=(N, H, W)."""
    share: float
    """Of a batch."""


@dataclass(frozen=True)
class TrainingData:
    """All that a network learns from."""

    reefs: tuple[PaintedReefs, ...]
    """The larger pictures first."""
    marked: tuple[MarkedPictures, ...]
    titles: NDArray[np.uint8]
    """Coverage by letters and by their boxes, to write over pictures. Shape=(K, 2, h, w)."""
    size: tuple[int, int] = (240, 320)
    """Height and width that the network learns at where there are no reefs."""


def paint_reefs(
    seed: int, reefs: int, pictures: int, size: tuple[int, int], processes: int = 1,
    tell: Callable[[str], None] = print,
) -> PaintedReefs:  # fmt: skip
    """Paint pictures of a size (px) of generated reefs, several reefs at a time in processes of their own.

    The number of processes changes nothing; `tell` is called with a line now and then.
    """
    jobs = [(1000 * seed + k, min(_REEFS_AT_A_TIME, reefs - k), pictures, size)
            for k in range(0, reefs, _REEFS_AT_A_TIME)]  # fmt: skip
    parts: list[PaintedReefs] = []
    if processes == 1:
        parts = [_paint_some(job) for job in jobs]
    else:
        with ProcessPoolExecutor(processes, get_context("spawn")) as pool:
            for part in pool.map(_paint_some, jobs):
                parts.append(part)
                tell(f"{sum(len(one.rgb) for one in parts)} of {reefs * pictures} painted pictures")
    return PaintedReefs(
        np.concatenate([part.rgb for part in parts]),
        np.concatenate([part.floor for part in parts]),
        np.concatenate([part.labels for part in parts]),
        np.concatenate([part.depth for part in parts]),
    )


def draw_collages(seed: int, count: int, size: tuple[int, int], *, bare: bool = False) -> MarkedPictures:
    """Draw collages of shells, or of bare floors, each kind in turn."""
    rng = np.random.default_rng([seed, 0xC0])
    painter = CollagePainter(rng)
    kinds = list(BARE)
    made = [bare_picture(kinds[k % len(kinds)], size, rng) if bare else painter.clumps(size, rng) for k in range(count)]
    share = _SHARES["bare" if bare else "clumps"]
    return MarkedPictures(np.stack([one.rgb for one in made]), np.stack([one.target for one in made]), share)


def gather_real(pictures: Iterable[LabelledPicture]) -> MarkedPictures:
    """Return real pictures at one size."""
    size = (_REAL_PX, _REAL_PX)
    rgb: list[NDArray[np.uint8]] = [np.zeros((0, *size, 3), np.uint8)]
    target: list[NDArray[np.uint8]] = [np.zeros((0, *size), np.uint8)]
    for one in pictures:
        rgb.append(np.asarray(cv2.resize(one.rgb, size, interpolation=cv2.INTER_AREA), np.uint8)[None])
        target.append(np.asarray(cv2.resize(one.target, size, interpolation=cv2.INTER_NEAREST), np.uint8)[None])
    return MarkedPictures(np.concatenate(rgb), np.concatenate(target), _SHARES["real"])


def teach(
    seed: int, *, reefs: int, pictures: int, real: MarkedPictures | None, processes: int = 1,
    tell: Callable[[str], None] = print,
) -> TrainingData:  # fmt: skip
    """Make the data of a training: pictures of painted reefs, of the same number again at half size, and real ones.

    Several processes paint; `tell` is called with a line now and then.
    """
    full, half = (320, 240), (160, 120)
    painted = tuple(
        paint_reefs(seed + k, reefs, pictures, size, processes, tell) for k, size in enumerate((full, half))
    )
    count = max(reefs * pictures // 4, 16)
    marked = [draw_collages(seed, count, full), draw_collages(seed + 1, count // 3, full, bare=True)]
    if real is not None and len(real.rgb):
        marked.append(real)
    return TrainingData(painted, tuple(marked), draw_titles(seed, 48, full))


def draw_titles(seed: int, count: int, size: tuple[int, int]) -> NDArray[np.uint8]:
    """Draw lines of letters as videos have them, and the boxes behind them. Shape=(count, 2, H, W)."""
    rng = np.random.default_rng([seed, 0x71])
    letters = np.array(list("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789.,:-   "))
    out = np.zeros((count, 2, size[1], size[0]), np.uint8)
    for cover in out:
        for _ in range(int(rng.integers(1, 4))):
            text = "".join(rng.choice(letters, int(rng.integers(4, 40))))
            scale, thick = float(rng.uniform(0.3, 1.0)), int(rng.integers(1, 3))
            (width, height), below = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, scale, thick)
            x, y = int(rng.uniform(-0.2, 0.8) * size[0]), int(rng.uniform(0.05, 1.0) * size[1])
            cv2.rectangle(cover[1], (x - 3, y - height - 3), (x + width + 3, y + below), 255, -1)
            cv2.putText(cover[0], text, (x, y), cv2.FONT_HERSHEY_SIMPLEX, scale, 255, thick, cv2.LINE_AA)
    return out


def _paint_some(job: tuple[int, int, int, tuple[int, int]]) -> PaintedReefs:
    seed, reefs, pictures, size = job
    samples = list(make_samples(seed, reefs, pictures, size))
    return PaintedReefs(
        np.stack([np.round((one.picture[:3].transpose(1, 2, 0) + 1.0) * 127.5) for one in samples]).astype(np.uint8),
        np.stack([one.picture[3] for one in samples]).astype(np.float16),
        np.stack([one.labels for one in samples]),
        np.stack([one.depth for one in samples]).astype(np.float16),
    )
