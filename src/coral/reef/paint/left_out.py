"""How well a network finds oysters in real pictures that it was not trained on, video by video."""

from __future__ import annotations

from typing import Any

import cv2
import torch

from coral.reef.paint.familiar import picture_input
from coral.reef.paint.labelled_pictures import UNKNOWN, LabelledPicture
from coral.reef.paint.unet import ReefNet
from coral.reef.world.geometry import Label

SHARPNESS, LEAN = 0.63, -0.21
"""What the logits of oysters are multiplied by and added to: fitted to ten networks, each on the videos left out of its
training, because a network is surer of a place that it has not seen than it should be."""
OYSTER_FROM = 0.35
"""Probability, so corrected, from which a pixel is an oyster: the best IoU of the videos left out."""


def correct_odds(net: ReefNet) -> None:
    """Make a network as sure as such networks have been right on videos left out."""
    net.sharpness[:], net.lean[int(Label.OYSTER)] = SHARPNESS, LEAN


def measure_left_out(net: ReefNet, pictures: list[LabelledPicture]) -> list[dict[str, Any]]:
    """Return IoU, precision and recall of the oyster pixels by video.

    A pixel counts as oyster from a probability of `OYSTER_FROM`. A box counts whole. `said` and `true` are the shares
    of oysters by the network's probabilities and by the outlines.
    """
    counts: dict[str, list[float]] = {}
    for one in pictures:
        with torch.no_grad():
            logits = net(torch.from_numpy(picture_input(one.rgb)[None]))[0][0]
        likely = torch.softmax(logits, dim=0)[int(Label.OYSTER)].numpy()
        said = likely > OYSTER_FROM
        size = (said.shape[1], said.shape[0])
        target = cv2.resize(one.target, size, interpolation=cv2.INTER_NEAREST)
        true = (target == int(Label.OYSTER)) | (target == UNKNOWN)
        found = [(said & true).sum(), said.sum(), true.sum(), likely.sum(), true.size]
        counts[one.video] = [a + float(b) for a, b in zip(counts.get(one.video, [0.0] * 5), found, strict=True)]
    return [
        {
            "video": video,
            "iou": round(both / max(said + true - both, 1), 3),
            "precision": round(both / max(said, 1), 3),
            "recall": round(both / max(true, 1), 3),
            "said": round(likely / pixels, 3),
            "true": round(true / pixels, 3),
        }
        for video, (both, said, true, likely, pixels) in sorted(counts.items())
    ]
