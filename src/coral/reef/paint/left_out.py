"""How well a network finds oysters in real pictures that it was not trained on, video by video."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import torch

from coral.reef.paint.familiar import picture_input
from coral.reef.paint.labelled_pictures import UNKNOWN, LabelledPicture
from coral.reef.paint.unet import ReefNet
from coral.reef.world.geometry import Label


def measure_left_out(net: ReefNet, pictures: list[LabelledPicture]) -> list[dict[str, Any]]:
    """Return IoU, precision and recall of the oyster pixels by video.

    A pixel counts as oyster where that is likelier than all else together. A box counts whole.
    """
    counts: dict[str, list[int]] = {}
    for one in pictures:
        with torch.no_grad():
            logits = net(torch.from_numpy(picture_input(one.rgb)[None]))[0][0].numpy()
        others = np.logaddexp.reduce(np.delete(logits, int(Label.OYSTER), axis=0), axis=0)
        said = logits[Label.OYSTER] > others
        size = (said.shape[1], said.shape[0])
        target = cv2.resize(one.target, size, interpolation=cv2.INTER_NEAREST)
        true = (target == int(Label.OYSTER)) | (target == UNKNOWN)
        both, all_said, all_true = counts.setdefault(one.video, [0, 0, 0])
        counts[one.video] = [both + int((said & true).sum()), all_said + int(said.sum()), all_true + int(true.sum())]
    return [
        {
            "video": video,
            "iou": round(both / max(said + true - both, 1), 3),
            "precision": round(both / max(said, 1), 3),
            "recall": round(both / max(true, 1), 3),
        }
        for video, (both, said, true) in sorted(counts.items())
    ]
