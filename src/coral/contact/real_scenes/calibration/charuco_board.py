"""A ChArUco board to calibrate with: its description in a word, its print, its corners in pictures."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.contact.scene.observation import Array
from coral.errors import InputError

FORM = "COLUMNSxROWS:SQUARE_M:MARKER_M[:DICTIONARY], for example 7x5:0.04:0.03"
DICTIONARY = "4X4_50"
LEAST_CORNERS = 6
"""Corners in a picture that make it count."""


@dataclass(frozen=True)
class SeenBoard:
    """The corners of a board in one picture."""

    points: Array
    """On the board, Shape=(N, 3) m."""
    pixels: Array
    """In the picture, Shape=(N, 2)."""


class CharucoBoard:
    """A board of squares with markers. Its origin is a corner, x along its columns, y along its rows, z away from it.

    Raises:
        InputError: The word describes no board.
    """

    def __init__(self, word: str) -> None:
        found = re.fullmatch(r"(\d+)x(\d+):([\d.]+):([\d.]+)(?::(\w+))?", word)
        if found is None:
            raise InputError("--board", "", repr(word), FORM)
        columns, rows = int(found[1]), int(found[2])
        try:
            self.square_m, marker_m = float(found[3]), float(found[4])
        except ValueError:
            raise InputError("--board", "", repr(word), FORM) from None
        name = (found[5] or DICTIONARY).upper().removeprefix("DICT_")
        dictionary = getattr(cv2.aruco, f"DICT_{name}", None)
        if dictionary is None:
            raise InputError(
                "--board", "dictionary", name, "a dictionary of OpenCV: 4X4_50, 5X5_100, APRILTAG_36H11 ..."
            )
        if not (3 <= columns <= 40 and 3 <= rows <= 40 and 0.001 < marker_m < self.square_m < 1.0):
            raise InputError("--board", "", repr(word), f"3 to 40 squares a side, markers smaller than squares: {FORM}")
        markers = cv2.aruco.getPredefinedDictionary(dictionary)
        if columns * rows // 2 > len(markers.bytesList):
            expected = f"a dictionary with {columns * rows // 2} markers; this one has {len(markers.bytesList)}"
            raise InputError("--board", "dictionary", name, expected)
        self._board: Any = cv2.aruco.CharucoBoard((columns, rows), self.square_m, marker_m, markers)
        old: Any = cv2.aruco.CharucoBoard((columns, rows), self.square_m, marker_m, markers)
        old.setLegacyPattern(True)  # until OpenCV 4.6, and from calib.io: with even rows the first square is white
        boards = (self._board, old) if rows % 2 == 0 else (self._board,)
        self._detectors: list[tuple[Any, Any]] = [(board, cv2.aruco.CharucoDetector(board)) for board in boards]
        self.size = (columns, rows)

    def draw(self, pixels_per_square: int) -> NDArray[np.uint8]:
        """Draw the board to print it, without a margin. Shape=(H, W), grey."""
        columns, rows = self.size
        return np.asarray(self._board.generateImage((columns * pixels_per_square, rows * pixels_per_square)), np.uint8)

    def find(self, rgb: NDArray[np.uint8]) -> SeenBoard | None:
        """Find the board's corners in a picture, Shape=(H, W, 3), red first; None if too few are seen."""
        grey = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
        for board, detector in self._detectors:
            corners, numbers, _, _ = detector.detectBoard(grey)
            if numbers is not None and len(numbers) >= LEAST_CORNERS:
                points, pixels = board.matchImagePoints(corners, numbers)
                return SeenBoard(np.asarray(points, float).reshape(-1, 3), np.asarray(pixels, float).reshape(-1, 2))
        return None
