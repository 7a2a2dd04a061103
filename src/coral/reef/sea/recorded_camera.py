"""The camera of a recording: its lens, how it is mounted, and the camera that rectified pictures are of."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from coral.config import Positive, Signed, merge
from coral.errors import InputError
from coral.lens import DistortionModel, Lens, check_lens
from coral.reef.sea.calibration_file import read_calibration
from coral.reef.sea.lens import LARGEST_WIDTH, Rectifier, rectified_size
from coral.reef.vehicle.camera import CameraCfg

Pixels = Annotated[int, Field(ge=1, le=65_536)]


@dataclass(frozen=True, kw_only=True)
class CameraFileCfg:
    """A camera file, `camera.yaml`. Either the field of view is given, or focal lengths of a calibration in water."""

    width: Pixels = 160
    height: Pixels = 120
    """Of the pictures (px)."""
    hfov_deg: float | None = None
    """Horizontal field of view of a picture without distortion (degrees); 120 if there are no focal lengths either."""
    fx: Positive | None = None
    fy: Positive | None = None
    """Focal lengths (px)."""
    cx: float | None = None
    cy: float | None = None
    """Principal point (px); by default the middle."""
    model: DistortionModel = "plumb_bob"
    """Of the distortion, as sensor_msgs/CameraInfo names it; equidistant is OpenCV's fisheye."""
    distortion: tuple[Signed, ...] = ()
    """Its coefficients: k1, k2, p1, p2, k3 of plumb_bob; k1 to k4 of equidistant."""
    pitch_down_deg: Signed = 15.0
    """Tilt of the optical axis."""
    altitude_m: Positive | None = None
    """Height above the seabed where the poses have none; 1 m, but with an autopilot's log it must be known."""
    range_m: Positive = 12.0
    near_m: Positive = 0.02
    """Farthest and nearest depth that counts (m)."""


@dataclass(frozen=True)
class RecordedCamera:
    """A recording's camera."""

    view: CameraCfg
    """The camera that rectified pictures are of: all that reads a recording knows only this one."""
    size: tuple[int, int]
    """Width and height of the pictures in the recording (px)."""
    rectifier: Rectifier | None = None
    """None: pictures are of `view` as they are."""
    altitude_given: bool = True
    """Whether somebody has stated the height of `view` above the seabed."""

    @classmethod
    def plain(cls, view: CameraCfg) -> RecordedCamera:
        """Return a camera whose pictures need no rectification."""
        return cls(view, (view.width, view.height))

    @classmethod
    def of(cls, lens: Lens, mount: CameraCfg, where: str, most_width: int = LARGEST_WIDTH) -> RecordedCamera:
        """Return the camera with a lens; of `mount` come tilt, height and range. Wider pictures are reduced (px).

        Raises:
            InputError: The lens, of the file or topic `where`, cannot be used.
        """
        width, height, hfov_deg = rectified_size(check_lens(lens, where), where, most_width)
        view = CameraCfg(
            width=width, height=height, hfov_deg=hfov_deg, pitch_down_deg=mount.pitch_down_deg,
            altitude_m=mount.altitude_m, range_m=mount.range_m, near_m=mount.near_m,
        )  # fmt: skip
        same = lens.is_plain and (width, height) == (lens.width, lens.height)
        return cls(view, (lens.width, lens.height), None if same else Rectifier(lens, view))

    def picture(self, rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Return a colour picture as `view` shows it. Shape=(H, W, 3).

        Raises:
            ValueError: It has another size than the camera's.
        """
        (height, width), size = rgb.shape[:2], self.size
        if (width, height) != size:
            raise ValueError(f"pictures of {width}x{height} px, where the camera file says {size[0]}x{size[1]}")
        return rgb if self.rectifier is None else self.rectifier.colours(rgb)


def read_camera(path: Path, most_width: int = LARGEST_WIDTH) -> RecordedCamera:
    """Read a camera file, or a calibration that another tool has written, for pictures of at most so many columns.

    Raises:
        InputError: A key is unknown, a value is out of range, or field of view and focal lengths contradict.
    """
    where = str(path)
    cfg = merge(CameraFileCfg(), read_calibration(path), where)
    if (cfg.fx is None) != (cfg.fy is None):
        raise InputError(where, "fx, fy", "one without the other", "both")
    if cfg.fx is not None and cfg.hfov_deg is not None:
        raise InputError(where, "hfov_deg", "fx, fy besides", "a field of view or focal lengths, not both")
    if cfg.fx is None and cfg.distortion:
        raise InputError(where, "distortion", "no fx, fy", "focal lengths of the same calibration")
    mount = CameraCfg(
        width=cfg.width, height=cfg.height, hfov_deg=120.0 if cfg.hfov_deg is None else cfg.hfov_deg,
        pitch_down_deg=cfg.pitch_down_deg, altitude_m=cfg.altitude_m or 1.0, range_m=cfg.range_m, near_m=cfg.near_m,
    )  # fmt: skip
    focal = 0.5 * cfg.width / math.tan(math.radians(mount.hfov_deg) / 2)
    lens = Lens(
        width=cfg.width,
        height=cfg.height,
        fx=cfg.fx or focal,
        fy=cfg.fy or focal,
        cx=(cfg.width - 1) / 2 if cfg.cx is None else cfg.cx,
        cy=(cfg.height - 1) / 2 if cfg.cy is None else cfg.cy,
        model=cfg.model,
        distortion=cfg.distortion,
    )
    return replace(RecordedCamera.of(lens, mount, where, most_width), altitude_given=cfg.altitude_m is not None)
