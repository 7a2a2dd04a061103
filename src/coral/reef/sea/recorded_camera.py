"""The camera of a recording: its file, how it is mounted, and its pictures as those of a pinhole camera."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from coral.config import Positive, Signed, merge
from coral.errors import InputError
from coral.foreign_file import read_text
from coral.lens import MOST_PIXELS, DistortionModel, Lens, check_lens
from coral.reef.vehicle.camera import CameraCfg
from coral.yaml_file import load_mapping

WIDEST_DEG = 120.0
"""Widest horizontal field of view of a rectified picture: beyond it a plane picture stretches its edges more than
fourfold, and no network here is trained on it."""
LARGEST_WIDTH = 1280
"""Larger pictures are reduced to this width (px): over 90 degrees its pixels are 1.6 mm wide at 1 m, finer than any
product needs."""
MOUNT = ("pitch_down_deg", "altitude_m", "range_m", "near_m")
"""Keys of a camera file that no calibration has: they may be added to it, at its top level."""
_OPENCV_YAML = re.compile(r"\A%YAML[: ][0-9.]+")
"""OpenCV's first line, which is none of YAML; its JSON is YAML as it stands."""

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


def read_calibration(path: Path) -> dict[str, Any]:
    """Read a camera file, or a calibration that ROS or OpenCV wrote (YAML, JSON), with the keys of `CameraFileCfg`.

    Raises:
        InputError: It cannot be read, is neither YAML nor JSON, or is a calibration that is not whole.
    """
    where = str(path)
    text = _OPENCV_YAML.sub("", read_text(path, "a camera file or a calibration")).replace("!!opencv-matrix", "")
    content = load_mapping(text, where)
    lower = {str(key).lower(): value for key, value in content.items()}  # OpenCV once wrote Camera_Matrix, image_Width
    if "camera_matrix" not in lower:
        return dict(content)
    for key in ("image_width", "image_height"):
        if key not in lower:
            raise InputError(where, key, "nothing", "the size of the pictures (px): add it to the file")
    k = _numbers(lower["camera_matrix"], where, "camera_matrix: data", 9)
    distortion = _numbers(lower.get("distortion_coefficients", {"data": []}), where, "distortion_coefficients: data")
    usual = "plumb_bob" if len(distortion) <= 5 else "rational_polynomial"
    model = lower.get("distortion_model", "fisheye" if lower.get("fisheye_model") else usual)
    return {
        "width": lower["image_width"], "height": lower["image_height"],
        "fx": k[0], "fy": k[4], "cx": k[2], "cy": k[5],
        "model": "equidistant" if model == "fisheye" else model, "distortion": distortion,
        **{key: content[key] for key in MOUNT if key in content},
    }  # fmt: skip


def _numbers(matrix: Any, where: str, field: str, count: int | None = None) -> list[Any]:
    data = matrix.get("data") if isinstance(matrix, Mapping) else None
    if (
        isinstance(data, list)
        and all(isinstance(one, int | float) for one in data)
        and len(data) == (count or len(data))
    ):
        return data
    raise InputError(where, field, repr(data)[:80], f"{count or 'some'} numbers")


def rectified_size(lens: Lens, where: str, most_width: int = LARGEST_WIDTH) -> tuple[int, int, float]:
    """Return width, height (px) and horizontal field of view (degrees) of pictures after rectification.

    The view is the largest symmetric one whose edges the picture still reaches in the middle of each side. Wider
    pictures than `most_width` (px) are reduced.

    Raises:
        InputError: The picture does not reach both sides of its optical axis.
    """
    if lens.is_plain:
        width = min(lens.width, most_width)
        fov = math.degrees(2.0 * math.atan(0.5 * lens.width / lens.fx))
        return width, round(lens.height * width / lens.width), round(fov, 9)
    right, bottom = lens.width - 0.5, lens.height - 0.5
    edges = lens.slopes(np.array([[-0.5, lens.cy], [right, lens.cy], [lens.cx, -0.5], [lens.cx, bottom]], np.float64))
    across = min(-edges[0, 0], edges[1, 0], math.tan(math.radians(WIDEST_DEG / 2)))
    down = min(-edges[2, 1], edges[3, 1])
    if not (0.05 < across < math.inf and 0.05 < down < math.inf):
        raise InputError(where, "distortion", list(lens.distortion), "a lens whose picture reaches all four sides")
    if not lens.width * down / across <= MOST_PIXELS:
        raise InputError(where, "fx, fy", f"{lens.fx:g} and {lens.fy:g}", "focal lengths of one camera, nearly equal")
    width = min(lens.width, most_width)
    return width, max(round(width * down / across), 2), round(math.degrees(2.0 * math.atan(across)), 9)


class Rectifier:
    """Turns pictures of a lens into those of a pinhole camera with square pixels, by looking pixels up."""

    def __init__(self, lens: Lens, view: CameraCfg) -> None:
        """Prepare the maps from a recording's lens to a view of the same direction."""
        self._size = view.width, view.height
        # At the resolution of the recording: reducing comes after, averaging over pixels.
        self._fine = max(lens.width / view.width, 1.0)
        width, height = round(view.width * self._fine), round(view.height * self._fine)
        focal, _, _, _ = view.intrinsics
        focal *= width / view.width
        matrix = np.array([[focal, 0.0, (width - 1) / 2], [0.0, focal, (height - 1) / 2], [0.0, 0.0, 1.0]])
        prepare: Any = (
            cv2.fisheye.initUndistortRectifyMap if lens.model == "equidistant" else cv2.initUndistortRectifyMap
        )
        coefficients = np.array(lens.distortion or (0.0,) * 4)
        self._u, self._v = prepare(lens.matrix, coefficients, np.eye(3), matrix, (width, height), cv2.CV_32FC1)
        self.outside: NDArray[np.bool_] = self._look_up(np.ones((lens.height, lens.width), np.uint8), nearest=True) == 0
        """Pixels of the result that the lens does not show. Shape=(H, W)."""

    def colours(self, rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Return a colour picture, black where the lens shows nothing. Shape=(H, W, 3)."""
        return np.asarray(self._look_up(rgb, nearest=False), np.uint8)

    def values(self, image: NDArray[Any]) -> NDArray[Any]:
        """Return a picture of values that must not be mixed, such as classes; 0 outside. Shape=(H, W)."""
        return self._look_up(image, nearest=True)

    def _look_up(self, image: NDArray[Any], *, nearest: bool) -> NDArray[Any]:
        how = cv2.INTER_NEAREST if nearest else cv2.INTER_LINEAR
        looked = cv2.remap(image, self._u, self._v, how, borderMode=cv2.BORDER_CONSTANT, borderValue=0)
        if (looked.shape[1], looked.shape[0]) != self._size:
            looked = cv2.resize(looked, self._size, interpolation=cv2.INTER_NEAREST if nearest else cv2.INTER_AREA)
        return np.ascontiguousarray(looked)
