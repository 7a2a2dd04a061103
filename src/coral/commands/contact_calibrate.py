"""`coral contact calibrate`: find where a camera stands, from a board."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Annotated, Any

import cv2
import numpy as np

from coral.contact.perception.camera import RgbdFrame
from coral.contact.real_scenes.calibration.board_calibration import calibrate_by_held_board, calibrate_by_placed_board
from coral.contact.real_scenes.calibration.camera_pose_file import (
    CameraCalibration,
    read_hand_poses,
    write_camera_pose,
)
from coral.contact.real_scenes.calibration.charuco_board import LEAST_CORNERS, CharucoBoard
from coral.contact.real_scenes.cameras.camera_registry import CAMERAS, make_camera_by_name
from coral.contact.real_scenes.cameras.rgbd_camera import stream_frames
from coral.contact.scene.geometry import pose_matrix, rotation_about
from coral.errors import InputError
from coral.file_writer import write_whole
from coral.flags import Option, forms_text

MOST_PICTURES = 500


@dataclass(frozen=True, kw_only=True)
class ContactCalibrate:
    """Find where a camera stands, and write it into a file for --camera-pose.

    With --board-at a ChArUco board lies at a known place; with --hand-poses the hand holds it, one picture for each of
    its poses.
    """

    camera: Annotated[str | None, Option(metavar="CAMERA", help=f"The camera: {forms_text(CAMERAS)}.")] = None
    board: Annotated[str, Option(metavar="BOARD")]
    """The board, COLUMNSxROWS:SQUARE_M:MARKER_M[:DICTIONARY], for example 7x5:0.04:0.03."""
    board_at: Annotated[tuple[float, float, float, float] | None, Option(metavar="X Y Z YAW_DEG")] = None
    """Place of the board, face up: its first corner in the world (m), and the direction of its columns."""
    hand_poses: Path | None = None
    """File with a list `poses` of `position` and `quaternion` of the tool, one for each picture."""
    pictures: int = 10
    """Pictures of a live camera."""
    draw: Annotated[Path | None, Option(metavar="PNG")] = None
    """Draw the board into this file to print it, and calibrate nothing."""
    out: Path = Path("camera.yaml")
    """The file to write, new."""
    json: bool = False
    """Print one JSON object on standard output."""

    def __call__(self) -> Mapping[str, Any]:
        if self.draw is not None:
            return self._draw(self.draw)
        if (self.board_at is None) == (self.hand_poses is None):
            found = "both" if self.board_at else "nothing"
            raise InputError("--board-at", "", found, "either --board-at or --hand-poses")
        if self.camera is None:
            raise InputError("--camera", "", "nothing", "a camera, or --draw")
        if self.out.exists():
            raise InputError("--out", "", str(self.out), "a new file")
        if not 1 <= self.pictures <= MOST_PICTURES:
            raise InputError("--pictures", "", self.pictures, f"1 to {MOST_PICTURES}")
        placing, method = self._by_board(self._take(self.camera))
        self.out.parent.mkdir(parents=True, exist_ok=True)
        write_camera_pose(self.out, placing, method)
        placed = placing.T_world_camera
        return {
            "out": str(self.out),
            "method": method,
            "position_m": [round(float(value), 5) for value in placed[:3, 3]],
            "looks_along": [round(float(value), 4) for value in placed[:3, 2]],
            "residuals": placing.residuals,
        }

    def describe(self, result: Mapping[str, Any]) -> str:
        if "drawn" in result:
            return f"{result['drawn']}: print it so that it is {result['width_m']:g} x {result['height_m']:g} m"
        x, y, z = result["position_m"]
        left = ", ".join(f"{name} {value:.2f}" for name, value in result["residuals"].items())
        return f"{result['method']}: the camera stands at {x:+.3f} {y:+.3f} {z:+.3f} m; {left}\n{result['out']}"

    def _draw(self, path: Path) -> dict[str, Any]:
        if path.exists():
            raise InputError("--draw", "", str(path), "a new file")
        board = CharucoBoard(self.board)
        write_whole(path, cv2.imencode(".png", board.draw(200))[1].tobytes())
        columns, rows = board.size
        return {"drawn": str(path), "width_m": columns * board.square_m, "height_m": rows * board.square_m}

    def _take(self, word: str) -> list[RgbdFrame]:
        with closing(make_camera_by_name(word)) as camera:
            if camera.live and self.hand_poses is not None:
                raise InputError("--camera", "", word, "a recording with one picture for each pose of the hand")
            camera.start()
            frames = list(islice(stream_frames(camera), self.pictures if camera.live else MOST_PICTURES))
        if not frames:
            raise InputError("--camera", "", word, "pictures")
        return frames

    def _by_board(self, frames: list[RgbdFrame]) -> tuple[CameraCalibration, str]:
        board = CharucoBoard(self.board)
        colours = [frame.rgb for frame in frames if frame.rgb is not None]
        if len(colours) < len(frames):
            raise InputError("--camera", "", "a picture without colours", "pictures with colours, which show the board")
        seen = [board.find(rgb) for rgb in colours]
        shown = [(one, frame) for one, frame in zip(seen, frames, strict=True) if one is not None]
        if not shown:
            expected = f"{LEAST_CORNERS} corners of the board {self.board} in a picture"
            raise InputError("--board", "", f"no board in {len(frames)} pictures", expected)
        boards, pictures = [one for one, _ in shown], [frame for _, frame in shown]
        if self.hand_poses is not None:
            tools = read_hand_poses(self.hand_poses)
            if len(tools) != len(frames):
                found_count = f"{len(tools)} poses for {len(frames)} pictures"
                raise InputError(str(self.hand_poses), "poses", found_count, "one pose for each picture")
            chosen = [tool for tool, one in zip(tools, seen, strict=True) if one is not None]
            fit = calibrate_by_held_board(boards, pictures, chosen, str(self.hand_poses))
            return fit, f"board in the hand, {len(boards)} pictures"
        assert self.board_at is not None
        x, y, z, yaw_deg = self.board_at
        turn = rotation_about(np.array([0.0, 0.0, 1.0]), float(np.radians(yaw_deg)))
        placed = pose_matrix(turn @ np.diag([1.0, -1.0, -1.0]), [x, y, z])
        return calibrate_by_placed_board(boards, pictures, placed), f"board at a known place, {len(boards)} pictures"
