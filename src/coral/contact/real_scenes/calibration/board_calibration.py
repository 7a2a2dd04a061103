"""Calibration by a board: at a known place, or held by the hand at known poses."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from coral.contact.perception.camera import RgbdFrame
from coral.contact.real_scenes.calibration.camera_pose_file import CameraCalibration
from coral.contact.real_scenes.calibration.charuco_board import SeenBoard
from coral.contact.scene.geometry import inverse_transform, pose_matrix, rotation_angle
from coral.contact.scene.observation import Array
from coral.errors import InputError

LIMIT_PX = 1.5
"""Largest root mean square of the corners' residuals; corners are found to a tenth of a pixel, and hands move."""
LEAST_PICTURES = 4
"""Pictures of a board in the hand."""
LEAST_TURN_DEG = 20.0
"""Least rotation of the hand between some two of them: pure shifts leave the camera's orientation weak."""
DEPTH_LIMIT = 0.03
"""Largest difference between the board's distance by its squares and by the measured depth, as a share."""


def locate_board(board: SeenBoard, lens: Array) -> Array:
    """Compute T_camera_board, Shape=(4, 4)."""
    matrix = np.array([[lens[0], 0.0, lens[2]], [0.0, lens[1], lens[3]], [0.0, 0.0, 1.0]])
    _, turn, shift = cv2.solvePnP(board.points, board.pixels, matrix, None, flags=cv2.SOLVEPNP_IPPE)
    turn, shift = cv2.solvePnPRefineLM(board.points, board.pixels, matrix, None, turn, shift)
    return pose_matrix(cv2.Rodrigues(turn)[0], shift.ravel())


def calibrate_by_placed_board(
    boards: Sequence[SeenBoard], frames: Sequence[RgbdFrame], T_world_board: Array
) -> CameraCalibration:
    """Compute where the camera stands from pictures of a board at one known place, T_world_board, Shape=(4, 4).

    Raises:
        InputError: The corners do not fit one board within `LIMIT_PX`, or not the measured depth.
    """
    lens = frames[0].lens
    joined = SeenBoard(
        np.concatenate([board.points for board in boards]), np.concatenate([board.pixels for board in boards])
    )
    T_camera_board = locate_board(joined, lens)
    left = _root_mean_square([_reprojection(board, T_camera_board, lens) for board in boards])
    if left > LIMIT_PX:
        expected = f"{LIMIT_PX:g} pixels: a camera and a board that stand still, and its right description"
        raise InputError("--board", "", f"a residual of {left:.1f} pixels", expected)
    residuals = {"rms_px": left} | _depth_residual(boards, frames, [T_camera_board] * len(boards))
    return CameraCalibration(T_world_board @ inverse_transform(T_camera_board), residuals)


def calibrate_by_held_board(
    boards: Sequence[SeenBoard], frames: Sequence[RgbdFrame], tools: Sequence[Array], where: str
) -> CameraCalibration:
    """Compute where the camera stands from pictures of a board in the hand; how it is held is found too.

    Solves T_world_tool(i) T_tool_board = T_world_camera T_camera_board(i) (Shah, 2013) for the `tools`, T_world_tool,
    Shape=(4, 4), of each picture. `where` is the file of these poses, for errors.

    Raises:
        InputError: There are too few pictures, the hand hardly turned, or poses and pictures do not agree.
    """
    if len(boards) < LEAST_PICTURES:
        raise InputError(where, "", f"{len(boards)} pictures that show the board", f"{LEAST_PICTURES} or more")
    turn = max(rotation_angle(a[:3, :3], b[:3, :3]) for a in tools for b in tools)
    if np.degrees(turn) < LEAST_TURN_DEG:
        found = f"poses of the hand within {np.degrees(turn):.0f} degrees"
        raise InputError(where, "", found, f"{LEAST_TURN_DEG:.0f} degrees or more, about two axes")
    lens = frames[0].lens
    seen = [locate_board(board, lens) for board in boards]

    def fit(chosen: Sequence[int]) -> tuple[Array, list[Array], float]:
        T_tool_board, T_world_camera = solve_robot_world([tools[i] for i in chosen], [seen[i] for i in chosen])
        placed = [inverse_transform(T_world_camera) @ tools[i] @ T_tool_board for i in chosen]
        errors = [_reprojection(boards[i], pose, lens) for i, pose in zip(chosen, placed, strict=True)]
        return T_world_camera, placed, _root_mean_square(errors)

    every = range(len(boards))
    T_world_camera, placed, left = fit(every)
    if left > LIMIT_PX:
        field, found = "poses", f"a residual of {left:.1f} pixels"
        if len(boards) > LEAST_PICTURES:
            best, wrong = min((fit([i for i in every if i != k])[2], k) for k in every)
            if best <= LIMIT_PX:
                field, found = f"poses[{wrong}]", f"{found}; without it the others agree: it is of another place"
        raise InputError(where, field, found, f"{LIMIT_PX:g} pixels")
    return CameraCalibration(T_world_camera, {"rms_px": left} | _depth_residual(boards, frames, placed))


def solve_robot_world(A: Sequence[Array], B: Sequence[Array]) -> tuple[Array, Array]:
    """Solve A(i) X = Z B(i) for the rigid transforms X and Z: rotations by singular vectors, then positions.

    Source: Shah, "Solving the robot-world/hand-eye calibration problem using the Kronecker product" (2013).
    """
    K = sum(np.kron(b[:3, :3], a[:3, :3]) for a, b in zip(A, B, strict=True))
    u, _, vt = np.linalg.svd(np.asarray(K))
    x, z = _nearest_rotation(vt[0].reshape(3, 3).T), _nearest_rotation(u[:, 0].reshape(3, 3).T)
    left = np.concatenate([np.hstack([a[:3, :3], -np.eye(3)]) for a in A])
    right = np.concatenate([z @ b[:3, 3] - a[:3, 3] for a, b in zip(A, B, strict=True)])
    shifts = np.linalg.lstsq(left, right, rcond=None)[0]
    return pose_matrix(x, shifts[:3]), pose_matrix(z, shifts[3:])


def _nearest_rotation(matrix: Array) -> Array:
    matrix = matrix * np.sign(np.linalg.det(matrix))
    u, _, vt = np.linalg.svd(matrix)
    return np.asarray(u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt)


def _reprojection(board: SeenBoard, T_camera_board: Array, lens: Array) -> Array:
    """Return the residual of each corner, Shape=(N,) pixels."""
    points = board.points @ T_camera_board[:3, :3].T + T_camera_board[:3, 3]
    drawn = lens[2:] + lens[:2] * points[:, :2] / points[:, 2:]
    return np.asarray(np.linalg.norm(drawn - board.pixels, axis=1))


def _depth_residual(
    boards: Sequence[SeenBoard], frames: Sequence[RgbdFrame], placed: Sequence[Array]
) -> dict[str, float]:
    """Return the median of (measured - expected) / expected depth at the corners; nothing without depth."""
    shares = []
    for board, frame, pose in zip(boards, frames, placed, strict=True):
        expected = board.points @ pose[2, :3] + pose[2, 3]
        columns, rows = np.rint(board.pixels).astype(int).T
        height, width = frame.depth.shape
        measured = frame.depth[rows.clip(0, height - 1), columns.clip(0, width - 1)]
        shares.append(((measured - expected) / expected)[measured > 0])
    every = np.concatenate(shares)
    if not len(every):
        return {}
    share = float(np.median(every))
    if abs(share) > DEPTH_LIMIT:
        found = f"depth that is {share:+.0%} off the board's distance by its squares"
        expected = f"{DEPTH_LIMIT:.0%}: measure the squares, and check that depth is aligned"
        raise InputError("--board", "", found, expected)
    return {"depth_off_percent": 100 * share}


def _root_mean_square(errors: Sequence[Array]) -> float:
    return float(np.sqrt(np.mean(np.square(np.concatenate(list(errors))))))
