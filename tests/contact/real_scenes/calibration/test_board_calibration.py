"""Boards are drawn into pictures from known poses."""

import numpy as np
import pytest
from drawn_board import FLAT, PLACED, picture

from coral.contact.real_scenes.calibration.board_calibration import (
    calibrate_by_held_board,
    calibrate_by_placed_board,
    solve_robot_world,
)
from coral.contact.real_scenes.calibration.charuco_board import CharucoBoard
from coral.contact.scene.geometry import inverse_transform, pose_matrix, rotation_from_vector
from coral.errors import InputError


@pytest.fixture(scope="module")
def board():
    return CharucoBoard("7x5:0.04:0.03")


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
