"""Boards are drawn into pictures from known poses."""

import cv2
import numpy as np
import pytest

from coral.calibration_board import CharucoBoard
from coral.contact.perception.camera import RgbdFrame, look_at
from coral.contact.real_scenes.calibration.board_calibration import (
    calibrate_by_held_board,
    calibrate_by_placed_board,
    solve_robot_world,
)
from coral.contact.scene.geometry import rotation_from_vector
from coral.contact.scene.rigid_transform import inverse_transform, pose_matrix
from coral.errors import InputError

LENS = np.array([500.0, 500.0, 319.5, 239.5])
PLACED = look_at((-0.3, -0.5, 0.5), (0.1, 0.0, 0.0))
FLAT = pose_matrix(np.diag([1.0, -1.0, -1.0]), [0.0, 0.1, 0.0])


@pytest.fixture(scope="module")
def board():
    return CharucoBoard("7x5:0.04:0.03")


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


def held(board):
    """A board in the hand, at six poses."""
    T_tool_board = pose_matrix(rotation_from_vector([0.2, 0.1, 0.3]), [-0.14, -0.1, 0.02])
    turns = [(0, 0, 0), (0.4, 0, 0), (0, 0.4, 0), (0, 0, 0.5), (-0.3, 0.2, 0), (0.2, -0.3, 0.3)]
    steps = [(rotation_from_vector(turn), [0.01 * k, -0.02 * k, 0.55 + 0.02 * k]) for k, turn in enumerate(turns)]
    tools = [PLACED @ pose_matrix(*step) for step in steps]
    frames = [picture(board, tool @ T_tool_board) for tool in tools]
    return frames, [board.find(frame.rgb) for frame in frames], tools


def off(found):
    return 1e3 * np.linalg.norm(found[:3, 3] - PLACED[:3, 3])


def test_a_board_at_a_known_place_tells_where_the_camera_stands(board):
    frame = picture(board, FLAT)
    found = calibrate_by_placed_board([board.find(frame.rgb)], [frame], FLAT)
    assert off(found.T_world_camera) < 2.0
    assert found.residuals["rms_px"] < 0.5
    assert abs(found.residuals["depth_off_percent"]) < 1.0


def test_squares_of_another_size_are_noticed_by_depth(board):
    frame = picture(board, FLAT, depth_factor=1.1)
    with pytest.raises(InputError, match=r"\+10% off"):
        calibrate_by_placed_board([board.find(frame.rgb)], [frame], FLAT)


def test_a_board_that_moved_is_refused(board):
    frames = [picture(board, FLAT), picture(board, FLAT @ pose_matrix(np.eye(3), [0.01, 0, 0]))]
    with pytest.raises(InputError, match=r"a residual of .* pixels"):
        calibrate_by_placed_board([board.find(frame.rgb) for frame in frames], frames, FLAT)


def test_a_board_in_the_hand_and_a_wrong_pose(board):
    frames, boards, tools = held(board)
    found = calibrate_by_held_board(boards, frames, tools, "poses.yaml")
    assert off(found.T_world_camera) < 4.0
    assert found.residuals["rms_px"] < 1.0
    tools[3] = tools[3] @ pose_matrix(np.eye(3), [0.05, 0, 0])
    with pytest.raises(InputError, match=r"poses\.yaml: poses\[3\]: .* without it the others agree"):
        calibrate_by_held_board(boards, frames, tools, "poses.yaml")
    with pytest.raises(InputError, match="3 pictures that show the board"):
        calibrate_by_held_board(boards[:3], frames[:3], tools[:3], "poses.yaml")
    with pytest.raises(InputError, match="within 0 degrees"):
        calibrate_by_held_board(boards, frames, [tools[0]] * 6, "poses.yaml")


def test_hand_and_eye_are_found_exactly_from_exact_poses():
    rng = np.random.default_rng(0)

    def pose():
        return pose_matrix(rotation_from_vector(rng.normal(0, 1, 3)), rng.normal(0, 1, 3))

    X, Z, A = pose(), pose(), [pose() for _ in range(5)]
    x, z = solve_robot_world(A, [inverse_transform(Z) @ a @ X for a in A])
    assert x == pytest.approx(X, abs=1e-9)
    assert z == pytest.approx(Z, abs=1e-9)
