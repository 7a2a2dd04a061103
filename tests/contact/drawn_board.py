"""Boards, drawn into pictures from known poses."""

import cv2
import numpy as np

from coral.contact.perception.camera import RgbdFrame, look_at
from coral.contact.scene.geometry import inverse_transform, pose_matrix

LENS = np.array([500.0, 500.0, 319.5, 239.5])
PLACED = look_at((-0.3, -0.5, 0.5), (0.1, 0.0, 0.0))
FLAT = pose_matrix(np.diag([1.0, -1.0, -1.0]), [0.0, 0.1, 0.0])


def picture(board, T_world_board, depth_factor=1.0):
    """Draw a board as the camera sees it."""
    per_m = 60 / board.square_m
    flat = board.draw(60)
    pose = inverse_transform(PLACED) @ T_world_board
    matrix = np.array([[500.0, 0, 319.5], [0, 500.0, 239.5], [0, 0, 1.0]])
    # A pixel's centre lies half a pixel from the board's edge.
    to_board = np.array([[1 / per_m, 0, 0.5 / per_m], [0, 1 / per_m, 0.5 / per_m], [0, 0, 1.0]])
    homography = matrix @ np.column_stack([pose[:3, 0], pose[:3, 1], pose[:3, 3]]) @ to_board
    grey = cv2.warpPerspective(flat, homography, (640, 480), flags=cv2.INTER_AREA, borderValue=170)
    rays = np.linalg.inv(matrix) @ np.stack(
        [*np.meshgrid(np.arange(640), np.arange(480)), np.ones((480, 640))]
    ).reshape(3, -1)
    depth = (pose[:3, 2] @ pose[:3, 3]) / (pose[:3, 2] @ rays)
    measured = (depth_factor * depth).reshape(480, 640).clip(0, 5).astype(np.float32)
    rgb = np.repeat(grey[..., None], 3, axis=2)
    return RgbdFrame(measured, np.zeros((480, 640), np.uint8), (), LENS, np.eye(4), 0.0, rgb)
