"""`coral camera calibrate`: find the lens of a camera, in its housing under water, from a board before it."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from coral.config import Signed, checked
from coral.errors import InputError
from coral.file_writer import write_whole, writing
from coral.flags import Argument, Option
from coral.lens import DistortionModel
from coral.words import many

MOST_PICTURES = 60
"""Pictures that are looked at: more of them change the lens less than where the board was held."""
LEAST_EDGES = 0.6
"""Share of the picture's edges that corners should reach; beyond the corners the lens is only continued."""


@dataclass(frozen=True, kw_only=True)
class CameraCalibrate:
    """Find a camera's lens from pictures of a board, and write it for `reef sail --lens` and `reef map --camera`.

    A housing's port changes the lens in water: move the board before the camera in the pool, tilted to all sides, and
    into every corner of the picture.
    """

    pictures: Annotated[Path, Argument(metavar="PICTURES")]
    """Folder of pictures of one size, or a video; at most 60 of them, evenly spread, are looked at."""
    board: Annotated[str, Option(metavar="BOARD")]
    """The board, COLUMNSxROWS:SQUARE_M[:MARKER_M[:DICTIONARY]] in squares: 9x6:0.03:0.022 is a ChArUco board, 9x6:0.03
    a plain chessboard. `coral contact calibrate --draw` draws the first."""
    model: Annotated[DistortionModel | None, Option(metavar="MODEL")] = None
    """plumb_bob, rational_polynomial or equidistant, which is OpenCV's fisheye. By default equidistant where it is
    clearly better than plumb_bob on pictures that the fit did not know."""
    pitch_down_deg: Signed = 15.0
    """Tilt of the camera on the vehicle (degrees), for the file."""
    out: Path = Path("camera.yaml")
    """The file to write, new."""
    json: bool = False
    """Print one JSON object on standard output."""

    def __call__(self) -> Mapping[str, Any]:
        from coral.calibration_board import parse_board
        from coral.reef.recordings.timed_pictures import spread_pictures
        from coral.reef.sea.lens_calibration import LEAST_PICTURES, calibrate_lens, tells_enough
        from coral.yaml_file import to_yaml

        if not -90.0 <= checked(self, "flags").pitch_down_deg <= 90.0:
            raise InputError("--pitch-down-deg", "", self.pitch_down_deg, "an angle between -90 and 90 degrees")
        if os.path.lexists(self.out):
            raise InputError("--out", "", str(self.out), "a new file")
        board, where = parse_board(self.board), str(self.pictures)
        seen, looked, size = [], 0, (0, 0)
        for looked, (name, rgb) in enumerate(spread_pictures(self.pictures, MOST_PICTURES), 1):
            here = rgb.shape[1], rgb.shape[0]
            size = size if looked > 1 else here
            if here != size:
                expected = f"{size[0]} x {size[1]}, the size of the first picture"
                raise InputError(name, "", f"{here[0]} x {here[1]} pixels", expected)
            found = board.find(rgb)
            if found is not None and tells_enough(found):
                seen.append(found)
        if len(seen) < LEAST_PICTURES:
            told = f"the board {self.board} in {len(seen)} of {many(looked, 'picture')}"
            expected = f"{LEAST_PICTURES} pictures that show it: bring it nearer, into the light, and check --board"
            raise InputError(where, "", told, expected)
        fit = calibrate_lens(seen, size, self.model, where)
        lens = fit.lens
        told = f"{fit.rms_px:.2f} px in {fit.used} pictures; corners in {fit.reached:.0%} of the picture"
        content = {
            "width": lens.width, "height": lens.height,
            **{name: round(getattr(lens, name), 3) for name in ("fx", "fy", "cx", "cy")},
            "model": lens.model, "distortion": [round(one, 7) for one in lens.distortion],
            "pitch_down_deg": self.pitch_down_deg,
        }  # fmt: skip
        text = f"# coral camera calibrate: root mean square error {told}\n{to_yaml(content, default_flow_style=None)}"
        with writing("--out", expected="a new file"):
            write_whole(self.out, text, replace=False)
        return {
            "out": str(self.out), "model": lens.model, "fx": lens.fx, "fy": lens.fy, "cx": lens.cx, "cy": lens.cy,
            "distortion": list(lens.distortion), "rms_px": round(fit.rms_px, 4),
            "left_out_px": {name: round(px, 4) if math.isfinite(px) else None for name, px in fit.left_out_px.items()},
            "looked_at": looked, "found": len(seen), "used": fit.used,
            "reached": round(fit.reached, 3), "edges_reached": round(fit.edges_reached, 3),
        }  # fmt: skip

    def describe(self, result: Mapping[str, Any]) -> str:
        tried = [f"{name} {'none' if px is None else f'{px:.2f} px'}" for name, px in result["left_out_px"].items()]
        lines = [
            f"board found in {result['found']} of {many(result['looked_at'], 'picture')}, {result['used']} used",
            f"{result['model']}: fx {result['fx']:.1f}, fy {result['fy']:.1f}, cx {result['cx']:.1f}, "
            f"cy {result['cy']:.1f} px; root mean square error {result['rms_px']:.2f} px",
            f"error on pictures left out of the fit: {', '.join(tried)}",
            f"corners in {result['reached']:.0%} of the picture, {result['edges_reached']:.0%} of its edges",
        ]
        if result["edges_reached"] < LEAST_EDGES:
            lines.append(
                "! the edges were hardly reached: do not trust the lens there, or bring the board to all sides"
            )
        return "\n".join([*lines, str(result["out"])])
