import cv2
import numpy as np
import pytest

from coral.contact.real_scenes.calibration.charuco_board import CharucoBoard
from coral.errors import InputError


def coloured(grey):
    return np.repeat(grey[..., None], 3, axis=2)


def test_the_corners_of_its_own_picture_are_found():
    board = CharucoBoard("5x4:0.03:0.02")
    seen = board.find(coloured(np.pad(board.draw(40), 40, constant_values=255)))
    assert len(seen.points) == 4 * 3
    # 40 pixels for 0.03 m, and a margin of 40 pixels; a pixel's centre is half a pixel inside.
    assert seen.pixels == pytest.approx(39.5 + seen.points[:, :2] / 0.03 * 40, abs=0.2)


def test_a_picture_without_the_board_is_none():
    picture = coloured(np.full((80, 80), 128, np.uint8))
    assert CharucoBoard("5x4:0.03:0.02:apriltag_36h11").find(picture) is None


@pytest.mark.parametrize(
    "word",
    [
        "",
        "7x5",
        "9x6:",
        "9x6:.",
        "9x6:0.03",
        "9x6:0.03:",
        "7x5:0.02:0.03",
        "2x5:0.03:0.02",
        "7x5:0.03:0.02:nine",
        "7x5:...:1",
        "40x40:0.03:0.02",
    ],
)
def test_a_word_that_describes_no_board_is_one_line(word):
    with pytest.raises(InputError, match="--board"):
        CharucoBoard(word)


def test_a_board_of_the_old_pattern_is_found():
    board = CharucoBoard("8x6:0.03:0.02")
    old = cv2.aruco.CharucoBoard((8, 6), 0.03, 0.02, cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50))
    old.setLegacyPattern(True)
    drawn = old.generateImage((8 * 40, 6 * 40))
    assert (drawn != board.draw(40)).any()
    seen = board.find(coloured(np.pad(drawn, 40, constant_values=255)))
    assert len(seen.points) == 7 * 5
    assert seen.pixels == pytest.approx(39.5 + seen.points[:, :2] / 0.03 * 40, abs=0.2)
