"""A lens from pictures of a board, for housings under water: OpenCV's pinhole and fisheye models."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.calibration_board import SeenBoard
from coral.errors import InputError
from coral.lens import DistortionModel, Lens, check_lens
from coral.reef.sea.lens import rectified_size

Array = NDArray[np.float64]

LEAST_PICTURES = 8
"""Three unknowns of the pinhole and five of its distortion, each of which some other picture must confirm."""
LEAST_CORNERS = 8
"""In a picture: its pose takes six of their sixteen numbers."""
LEAST_TILT_DEG = 15.0
"""Between some two pictures. Boards that are parallel to each other cannot tell a long lens from a far board."""
LIMIT_PX = 1.5
"""Largest root mean square error. Corners are found to a few tenths of a pixel in clear water, and refraction at a flat
port leaves some more; above, the board is bent or described wrongly, or the pictures are blurred."""
OUTLIER = 3.0
"""A picture whose error is so many times the median is left out."""
LEFT_OUT_EVERY = 4
BETTER, BETTER_PX = 0.8, 0.05
"""Equidistant is chosen where its error on left-out pictures is below this share of plumb_bob's, and smaller by so many
pixels: less lies within what the choice of pictures changes."""
CELLS = (8, 6)
"""Columns and rows of the grid that says where corners were seen."""


@dataclass(frozen=True, kw_only=True)
class LensCalibration:
    """A lens, and how far it can be trusted."""

    lens: Lens
    rms_px: float
    """Root mean square distance of corners from where the lens shows them (px)."""
    used: int
    """Pictures of the fit, without those whose own error was too large."""
    reached: float
    edges_reached: float
    """Share of the cells of the picture, and of those at its edges, in which corners were seen."""
    left_out_px: dict[DistortionModel, float]
    """Error of each model that was tried on pictures that its fit did not know (px)."""


def calibrate_lens(
    boards: Sequence[SeenBoard], size: tuple[int, int], model: DistortionModel | None, where: str
) -> LensCalibration:
    """Fit a lens to pictures of a board, of one size (width, height; px).

    Without a model, plumb_bob or equidistant is chosen by their errors on every fourth picture, left out of the fit.

    Raises:
        InputError: No lens shows the corners within `LIMIT_PX`, the board was never tilted, or the lens is impossible.
    """
    models: tuple[DistortionModel, ...] = (model,) if model else ("plumb_bob", "equidistant")
    fits = {each: _fit(boards, size, each) for each in models}
    own = {each: _errors(lens, boards) for each, lens in fits.items()}
    # What any of the models shows well is no bad picture.
    good = [k for k in range(len(boards)) if any(_rms(e[k : k + 1]) <= OUTLIER * _middle(e) for e in own.values())]
    kept = [boards[k] for k in good]
    if len(kept) < LEAST_PICTURES:
        found = f"{len(kept)} pictures that agree about the lens, of {len(boards)}"
        raise InputError(where, "", found, f"{LEAST_PICTURES} or more: hold board and camera still for sharp pictures")
    known = [board for k, board in enumerate(kept) if k % LEFT_OUT_EVERY != LEFT_OUT_EVERY - 1]
    left = kept[LEFT_OUT_EVERY - 1 :: LEFT_OUT_EVERY]
    left_out_px = {each: _rms(_errors(_fit(known, size, each), left)) for each in models}
    chosen = models[0]
    if model is None:
        plain, wide = left_out_px["plumb_bob"], left_out_px["equidistant"]
        chosen = "equidistant" if wide < BETTER * plain and wide < plain - BETTER_PX else "plumb_bob"
    lens = fits[chosen] if len(kept) == len(boards) else _fit(kept, size, chosen)
    rms_px = _rms(_errors(lens, kept))
    if lens is None or not rms_px <= LIMIT_PX:
        expected = f"{LIMIT_PX:g}: a flat board as --board tells, sharp pictures, or another --model"
        raise InputError(where, "", f"an error of {rms_px:.1f} px with {chosen}", expected)
    _check_tilts(lens, kept, where)
    rectified_size(check_lens(lens, where), where)
    reached, edges_reached = _reached(kept, size)
    return LensCalibration(
        lens=lens, rms_px=rms_px, used=len(kept), reached=reached, edges_reached=edges_reached, left_out_px=left_out_px
    )


def tells_enough(board: SeenBoard) -> bool:
    """Check whether a picture of a board has enough corners, not all in a line."""
    return len(board.points) >= LEAST_CORNERS and np.linalg.matrix_rank(board.points - board.points.mean(0)) == 2


def _fit(boards: Sequence[SeenBoard], size: tuple[int, int], model: DistortionModel) -> Lens | None:
    """Return the lens with the least error; None if OpenCV finds none."""
    points = [board.points.astype(np.float32).reshape(1, -1, 3) for board in boards]
    pixels = [board.pixels.astype(np.float32).reshape(1, -1, 2) for board in boards]
    flags = cv2.CALIB_RATIONAL_MODEL if model == "rational_polynomial" else 0
    fits: list[tuple[float, Any, Any]] = []
    try:
        error, matrix, numbers, _, _ = cv2.calibrateCamera(points, pixels, size, None, None, flags=flags)  # type: ignore[call-overload]
        fits = [(error, matrix, numbers.ravel()[: 8 if flags else 5])]
    except cv2.error:
        matrix = np.diag([max(size) / math.pi] * 2 + [1.0])
    if model == "equidistant":
        # It finds its way only from near: from the pinhole's focal length, or that of a half circle in the picture.
        focals, fits = (float(matrix[0, 0]), max(size) / math.pi), []
        flags = cv2.CALIB_RECOMPUTE_EXTRINSIC + cv2.CALIB_FIX_SKEW
        for focal in focals:
            guess = np.array([[focal, 0, (size[0] - 1) / 2], [0, focal, (size[1] - 1) / 2], [0, 0, 1.0]])
            try:
                error, matrix, numbers, _, _ = cv2.fisheye.calibrate(
                    points, pixels, size, guess, np.zeros((4, 1)), flags=flags + cv2.CALIB_USE_INTRINSIC_GUESS
                )
                fits.append((error, matrix, numbers.ravel()))
            except cv2.error:
                continue
            if error <= LIMIT_PX:
                break
    found = [fit for fit in fits if math.isfinite(fit[0]) and np.isfinite(fit[1]).all()]
    if not found:
        return None
    _, k, numbers = min(found, key=lambda fit: fit[0])
    return Lens(
        width=size[0], height=size[1], fx=float(k[0, 0]), fy=float(k[1, 1]), cx=float(k[0, 2]), cy=float(k[1, 2]),
        model=model, distortion=tuple(map(float, numbers)),
    )  # fmt: skip


def _project(lens: Lens, points: Array, pose: Array) -> Array:
    """Return the pixels of a board's points; `pose` is its rotation vector and its position (m). Shape=(N, 2)."""
    project: Any = cv2.fisheye.projectPoints if lens.model == "equidistant" else cv2.projectPoints
    seen = project(points.reshape(-1, 1, 3), pose[:3], pose[3:], lens.matrix, np.array(lens.distortion))[0]
    return np.asarray(seen, np.float64).reshape(-1, 2)


def _locate(lens: Lens, board: SeenBoard) -> tuple[Array, float]:
    """Find the pose of a board and the sum of its corners' squared errors (px²), by Levenberg and Marquardt."""
    slopes = lens.slopes(board.pixels)
    if not (np.abs(slopes) < 1e3).all():  # beyond a half circle, or where the distortion folds
        return np.zeros(6), math.inf
    _, turn, shift = cv2.solvePnP(board.points, slopes, np.eye(3), None, flags=cv2.SOLVEPNP_IPPE)
    pose, damping = np.concatenate([turn.ravel(), shift.ravel()]), 1e-3
    off = (board.pixels - _project(lens, board.points, pose)).ravel()
    for _ in range(20):
        steps = [(_project(lens, board.points, pose + step) - board.pixels).ravel() + off for step in 1e-6 * np.eye(6)]
        slope = np.stack(steps, axis=1) / 1e-6
        normal = slope.T @ slope
        tried = pose + np.linalg.lstsq(normal + damping * np.diag(normal.diagonal()), slope.T @ off, rcond=None)[0]
        then = (board.pixels - _project(lens, board.points, tried)).ravel()
        gain = float(off @ off - then @ then)
        pose, off, damping = (tried, then, 0.1 * damping) if gain > 0.0 else (pose, off, 10.0 * damping)
        if abs(gain) < 1e-6 * float(off @ off):
            break
    return pose, float(off @ off)


def _errors(lens: Lens | None, boards: Sequence[SeenBoard]) -> Array:
    """Return the sum of squared errors (px²) and the number of corners of each picture. Shape=(N, 2)."""
    found = []
    for board in boards:
        try:
            error = math.inf if lens is None else _locate(lens, board)[1]
        except (cv2.error, np.linalg.LinAlgError):
            error = math.inf
        found.append((error if math.isfinite(error) else math.inf, len(board.points)))
    return np.array(found)


def _rms(errors: Array) -> float:
    total, corners = errors.sum(axis=0)
    return float(np.sqrt(total / corners))


def _middle(errors: Array) -> float:
    """Return the median of the pictures' errors (px); below 0, so that none is like it, where most are endless."""
    middle = float(np.median(np.sqrt(errors[:, 0] / errors[:, 1])))
    return middle if math.isfinite(middle) else -1.0


def _check_tilts(lens: Lens, boards: Sequence[SeenBoard], where: str) -> None:
    away = np.array([cv2.Rodrigues(_locate(lens, board)[0][:3])[0][:, 2] for board in boards])
    tilt = math.degrees(math.acos(float(np.clip((away @ away.T).min(), -1.0, 1.0))))
    if tilt < LEAST_TILT_DEG:
        expected = f"{LEAST_TILT_DEG:.0f} degrees or more: tilt it to all sides"
        raise InputError(where, "", f"a board that was tilted by {tilt:.0f} degrees", expected)


def _reached(boards: Sequence[SeenBoard], size: tuple[int, int]) -> tuple[float, float]:
    pixels = np.concatenate([board.pixels for board in boards]) + 0.5
    cells = np.minimum((pixels / size * CELLS).astype(int), np.array(CELLS) - 1)
    seen = np.zeros(CELLS, bool)
    seen[cells[:, 0], cells[:, 1]] = True
    edges = np.ones(CELLS, bool)
    edges[1:-1, 1:-1] = False
    return float(seen.mean()), float(seen[edges].mean())
