"""Boards before a camera with a known lens: their corners, and pictures of them."""

import cv2
import numpy as np

from coral.calibration_board import SeenBoard
from coral.lens import Lens

PLAIN = Lens(
    width=640, height=480, fx=410.0, fy=412.0, cx=325.0, cy=236.0, distortion=(-0.21, 0.06, 0.001, -0.0008, 0.0)
)
WIDE = Lens(
    width=640, height=480, fx=270.0, fy=271.0, cx=323.0, cy=243.0, model="equidistant",
    distortion=(-0.02, 0.004, -0.001, 0.0),
)  # fmt: skip
SIZE = (640, 480)


def poses(lens, count, square_m=0.03, squares=(9, 6), rng=None):
    """Rotation vectors and positions (m) of boards all over the picture, turned by up to 35 degrees."""
    rng = rng or np.random.default_rng(4)
    for k in range(count):
        column, row = k % 4, k // 4 % 3
        pixel = np.array([[lens.width * (0.12 + 0.253 * column), lens.height * (0.15 + 0.35 * row)]])
        slope = lens.slopes(pixel)[0]
        ray = np.array([*slope, 1.0]) / np.linalg.norm([*slope, 1.0])
        turn = cv2.Rodrigues(rng.uniform(-0.6, 0.6, 3))[0]
        # Facing the camera from its direction, then turned.
        facing = cv2.Rodrigues(np.cross([0.0, 0.0, 1.0], ray) * np.arccos(ray[2]) / max(np.hypot(*ray[:2]), 1e-9))[0]
        rotation = facing @ turn
        middle = np.array([squares[0], squares[1], 0.0]) * square_m / 2
        shift = ray * rng.uniform(0.22, 0.4) - rotation @ middle
        yield cv2.Rodrigues(rotation)[0].ravel(), shift


def project(lens, points, turn, shift):
    how = cv2.fisheye.projectPoints if lens.model == "equidistant" else cv2.projectPoints
    return how(points.reshape(-1, 1, 3), turn, shift, lens.matrix, np.array(lens.distortion))[0].reshape(-1, 2)


def corners(lens, count, noise_px=0.1, seed=4):
    """What a finder sees of the board: the inner corners that lie in the picture."""
    rng = np.random.default_rng(seed)
    across, down = np.meshgrid(np.arange(1.0, 9), np.arange(1.0, 6))
    points = np.column_stack([across.ravel(), down.ravel(), np.zeros(40)]) * 0.03
    seen = []
    for turn, shift in poses(lens, count, rng=rng):
        pixels = project(lens, points, turn, shift) + rng.normal(0.0, noise_px, (40, 2))
        inside = ((pixels >= 0) & (pixels <= [lens.width - 1, lens.height - 1])).all(axis=1)
        seen.append(SeenBoard(points[inside], pixels[inside]))
    return seen


def picture(lens, flat, per_m, turn, shift):
    """Draw a flat picture of a board, `per_m` pixels per metre, as the lens sees it. Shape=(H, W, 3)."""
    u, v = np.meshgrid(np.arange(lens.width, dtype=float), np.arange(lens.height, dtype=float))
    slopes = lens.slopes(np.stack([u.ravel(), v.ravel()], axis=1))
    rays = np.column_stack([slopes, np.ones(len(slopes))])
    rotation = cv2.Rodrigues(turn)[0]
    away = (rotation[:, 2] @ shift) / (rays @ rotation[:, 2])
    on_board = (rays * away[:, None] - shift) @ rotation * per_m - 0.5
    on_board[~(away > 0)] = -1e4
    maps = [on_board[:, k].reshape(u.shape).astype(np.float32) for k in (0, 1)]
    grey = cv2.remap(flat, *maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=200)
    return np.repeat(cv2.GaussianBlur(grey, (3, 3), 0.7)[..., None], 3, axis=2)
