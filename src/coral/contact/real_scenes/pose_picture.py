"""A picture with the outlines of the objects at their estimated poses: what a person checks first."""

from __future__ import annotations

from collections.abc import Mapping

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame, draw_depth
from coral.contact.perception.object_model import ObjectModel
from coral.contact.perception.tracker import PoseEstimate
from coral.contact.scene.geometry import inverse_transform

_GREEN, _WHITE = (60, 230, 60), (255, 255, 255)
WIDTH = 960
"""Columns of the picture, at least."""


def draw_poses(
    frame: RgbdFrame, models: Mapping[str, ObjectModel], estimates: Mapping[str, PoseEstimate]
) -> NDArray[np.uint8]:
    """Draw the outline and the name of each object that is not lost, on black without colours. Shape=(H, W, 3), RGB."""
    camera = inverse_transform(frame.T_world_camera)
    grow = max(1, -(-WIDTH // frame.depth.shape[1]))
    picture = frame.rgb if frame.rgb is not None else np.zeros((*frame.depth.shape, 3), np.uint8)
    canvas = cv2.resize(picture, None, fx=grow, fy=grow, interpolation=cv2.INTER_NEAREST)
    for name, estimate in estimates.items():
        if estimate.lost:
            continue
        drawn = np.isfinite(draw_depth(models[name].solids, camera @ estimate.T_world_object, frame))
        large = cv2.resize(drawn.astype(np.uint8), None, fx=grow, fy=grow, interpolation=cv2.INTER_NEAREST)
        outlines, _ = cv2.findContours(large, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        cv2.drawContours(canvas, outlines, -1, _GREEN, 2)
        if drawn.any():
            rows, columns = np.nonzero(large)
            place = (int(columns.min()), max(14, int(rows.min()) - 8))
            shadow = (place[0] + 1, place[1] + 1)
            cv2.putText(canvas, name, shadow, cv2.FONT_HERSHEY_SIMPLEX, 0.6, (0, 0, 0), 1, cv2.LINE_AA)
            cv2.putText(canvas, name, place, cv2.FONT_HERSHEY_SIMPLEX, 0.6, _WHITE, 1, cv2.LINE_AA)
    return np.asarray(canvas, np.uint8)
