"""How well a network finds oysters in real pictures that it was not trained on, video by video."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from coral.reef.paint.familiar import picture_input
from coral.reef.paint.labelled_pictures import LabelledPicture
from coral.reef.paint.score import video_rows
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
    """Return the rows of `video_rows`. A pixel counts as oyster from a probability of `OYSTER_FROM`."""
    return video_rows(_seen(net, one) for one in pictures)


def _seen(net: ReefNet, one: LabelledPicture) -> tuple[LabelledPicture, NDArray[np.bool_], NDArray[np.float32]]:
    with torch.no_grad():
        logits = net(torch.from_numpy(picture_input(one.rgb)[None]))[0][0]
    likely = torch.softmax(logits, dim=0)[int(Label.OYSTER)].numpy()
    return one, likely > OYSTER_FROM, likely
