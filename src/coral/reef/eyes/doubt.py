"""Which pixels are too doubtful to go onto the map, and which class is meant where a network hesitates."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from coral.config import Fraction
from coral.reef.world.geometry import Frame, Label

STEPS = 255
"""Steps that make 1 in a picture file of doubt."""


@dataclass(frozen=True, kw_only=True)
class DoubtCfg:
    """Largest doubt, by class, with which a pixel is evidence on the map. Frames of exact perception have no doubt."""

    oyster: Fraction = 0.3
    """Of the shipped network: in single pictures of the generated reefs `gen:0` to `gen:11` any limit from 0.1 to 0.5
    gives the same overlap within 3 m (mean IoU of three waters 0.58 to 0.59). A map, which adds up pictures, is better
    with less (docs/research/network-eyes.md)."""
    obstacle: Fraction = 0.7
    """More than for oysters: an obstacle too many costs a detour, one too few a collision."""
    seabed: Fraction = 0.5
    """Seabed counts against oysters and obstacles of its cell, so it has to be likelier than not."""


def drop_doubtful(frame: Frame, cfg: DoubtCfg) -> Frame:
    """Return a frame in which pixels with too much doubt have become water; the same frame if it has no doubt."""
    if frame.doubt is None:
        return frame
    most = np.array([1.0, cfg.oyster, cfg.obstacle, cfg.seabed], np.float32)
    lost = frame.doubt > most[np.minimum(frame.labels, len(most) - 1)]
    return replace(
        frame,
        depth=np.where(lost, np.float32(np.inf), frame.depth).astype(np.float32),
        labels=np.where(lost, np.uint8(Label.WATER), frame.labels).astype(np.uint8),
    )


def pack_doubt(share: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return doubt in steps of 1 / STEPS as bytes, for a picture file. Shape=(H, W)."""
    return np.clip(np.round(STEPS * share), 0, 255).astype(np.uint8)


def unpack_doubt(steps: NDArray[np.uint8]) -> NDArray[np.float32]:
    """The inverse of `pack_doubt`, to half a step. Shape=(H, W)."""
    return steps.astype(np.float32) / np.float32(STEPS)


def choose_labels(
    logits: NDArray[np.float32], obstacle_from: float, oyster_from: float | None = None
) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Choose the likeliest class of every pixel from logits in the order of `Label`, Shape=(4, H, W).

    A pixel is an obstacle from a probability of `obstacle_from` on, an oyster, before that, from `oyster_from` (None:
    only where it is likeliest). Returns labels and the probability that they are wrong. Shape=(H, W) each.
    """
    powers = np.exp(logits - logits.max(axis=0))
    shares = powers / powers.sum(axis=0)
    # Class by class: argmax over the first axis takes three times as long.
    labels, chosen = np.zeros(shares.shape[1:], np.uint8), shares[0]
    for label in range(1, len(shares)):
        labels[shares[label] > chosen] = label
        chosen = np.maximum(chosen, shares[label])
    for label, least in ((Label.OBSTACLE, obstacle_from), (Label.OYSTER, oyster_from)):
        if least is not None:
            enough = shares[label] >= least
            labels[enough] = label
            chosen = np.where(enough, shares[label], chosen)
    return labels, (1.0 - chosen).astype(np.float32)
