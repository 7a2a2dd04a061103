import dataclasses

import numpy as np
import pytest
from rendered_boards import PLAIN, SIZE, WIDE, corners, project

from coral.calibration_board import SeenBoard
from coral.errors import InputError
from coral.reef.sea.lens_calibration import calibrate_lens, tells_enough


def check_lens_is(found, true):
    assert (found.fx, found.fy) == pytest.approx((true.fx, true.fy), rel=0.01)
    assert (found.cx, found.cy) == pytest.approx((true.cx, true.cy), abs=3.0)
    u, v = np.meshgrid(np.linspace(20, 620, 7), np.linspace(20, 460, 5))
    pixels = np.stack([u.ravel(), v.ravel()], axis=1)
    rays = np.column_stack([true.slopes(pixels), np.ones(u.size)])
    # As far as the two centres differ the camera counts as turned.
    shifted = dataclasses.replace(found, cx=true.cx, cy=true.cy)
    assert np.abs(project(shifted, rays, np.zeros(3), np.zeros(3)) - pixels).max() < 0.5


@pytest.mark.parametrize("lens", [PLAIN, WIDE], ids=["plain", "wide"])
def test_the_lens_is_found_and_its_model_chosen(lens):
    fit = calibrate_lens(corners(lens, 16, noise_px=0.03), SIZE, None, "pool")
    check_lens_is(fit.lens, lens)
    assert fit.lens.model == lens.model
    assert fit.rms_px < 0.06
    assert set(fit.left_out_px) == {"plumb_bob", "equidistant"}
    assert (fit.reached, fit.edges_reached) > (0.7, 0.6)


def test_a_model_that_is_named_is_taken():
    fit = calibrate_lens(corners(PLAIN, 12), SIZE, "rational_polynomial", "pool")
    assert (len(fit.lens.distortion), list(fit.left_out_px)) == (8, ["rational_polynomial"])


def test_a_picture_that_does_not_agree_is_left_out():
    boards = corners(PLAIN, 16, noise_px=0.05)
    moved = boards[3].pixels + np.random.default_rng(1).normal(0.0, 4.0, boards[3].pixels.shape)
    fit = calibrate_lens([*boards[:3], SeenBoard(boards[3].points, moved), *boards[4:]], SIZE, "plumb_bob", "pool")
    assert fit.used == 15
    check_lens_is(fit.lens, PLAIN)


def test_corners_only_in_the_middle_are_told_by_the_edges():
    seen = []
    for board in corners(PLAIN, 24, 0.05):
        near = (abs(board.pixels - [319.5, 239.5]) < [230, 155]).all(axis=1)
        seen.append(SeenBoard(board.points[near], board.pixels[near]))
    fit = calibrate_lens([board for board in seen if tells_enough(board)], SIZE, "plumb_bob", "pool")
    assert (fit.edges_reached, fit.reached) == (0.0, 0.5)


def test_blurred_corners_and_a_board_that_was_never_tilted_are_refused():
    with pytest.raises(InputError, match=r"an error of \d\.\d px with plumb_bob, expected 1\.5"):
        calibrate_lens(corners(PLAIN, 12, noise_px=4.0), SIZE, "plumb_bob", "pool")
    flat = [
        SeenBoard(points, project(PLAIN, points, np.array([0.0, 0.0, 0.1 * k]), np.array([-0.1, -0.1, 0.3 + 0.02 * k])))
        for k, points in enumerate([corners(PLAIN, 1)[0].points] * 12)
    ]
    with pytest.raises(InputError, match=r"tilted by \d degrees"):
        calibrate_lens(flat, SIZE, "plumb_bob", "pool")


def test_few_corners_or_a_single_line_of_them_tell_nothing():
    board = corners(PLAIN, 6)[5]
    assert tells_enough(board)
    assert not tells_enough(SeenBoard(board.points[:8], board.pixels[:8]))  # one row
    assert not tells_enough(SeenBoard(board.points[4:11], board.pixels[4:11]))
