"""The front camera: exact ray casting of depth, class and object for every pixel."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.config import Signed
from coral.errors import InputError
from coral.reef.vehicle import camera_kernels
from coral.reef.world.geometry import Frame, Pose
from coral.reef.world.scene import Scene


@dataclass(frozen=True, kw_only=True)
class CameraCfg:
    """Pinhole camera at the body's origin with square pixels. Integer (u, v) are pixel centres."""

    width: int = 160
    height: int = 120
    """Pixels. The paper gives no size. At 6 m, 160 columns are 13 cm apart, about the size of one oyster."""
    hfov_deg: float = 120.0
    """Horizontal angle between the outer edges of the first and last column (paper IV-E: 120° camera FOV)."""
    altitude_m: float = 1.0
    """Height above the seabed. The paper gives none; this is half the depth of its pool."""
    pitch_down_deg: Signed = 15.0
    """Tilt of the optical axis. The picture then reaches from 0.4 m ahead on the seabed to 37° above the horizon."""
    range_m: float = 12.0
    """Surfaces beyond this range along the ray are not seen. Twice the range in the paper's prompts (0-6 m)."""
    near_m: float = 0.02
    """Surfaces closer than this along the optical axis are not seen."""

    def __post_init__(self) -> None:
        def demand(field: str, holds: bool, expected: str) -> None:
            if not holds:
                raise InputError("camera", field, getattr(self, field), expected)

        demand("width", self.width >= 2, "at least 2 pixels")
        demand("height", self.height >= 2, "at least 2 pixels")
        demand("hfov_deg", 0.0 < self.hfov_deg < 180.0, "an angle between 0 and 180 degrees")
        demand("altitude_m", self.altitude_m > 0.0, "a height above 0 m")
        demand("pitch_down_deg", -90.0 <= self.pitch_down_deg <= 90.0, "an angle between -90 and 90 degrees")
        demand("near_m", self.near_m > 0.0, "a distance above 0 m")
        demand("range_m", self.near_m < self.range_m < math.inf, "a finite distance above near_m")

    @property
    def intrinsics(self) -> tuple[float, float, float, float]:
        """(fx, fy, cx, cy) in pixels: u = cx + fx X / Z, v = cy + fy Y / Z (X right, Y down, Z forward)."""
        focal = 0.5 * self.width / math.tan(math.radians(self.hfov_deg) / 2)
        return focal, focal, (self.width - 1) / 2, (self.height - 1) / 2


def check_picture(frame: Frame, cfg: CameraCfg) -> None:
    """Check that a picture has the camera's size and the types that kernels are compiled for.

    Raises:
        InputError: It has not.
    """
    for name, image, dtype in (("depth", frame.depth, np.float32), ("labels", frame.labels, np.uint8)):
        if image.shape != (cfg.height, cfg.width) or image.dtype != dtype:
            raise InputError(
                "camera", name, f"{image.dtype} of shape {image.shape}",
                f"{np.dtype(dtype)} of shape ({cfg.height}, {cfg.width}), the configured height and width",
            )  # fmt: skip


def T_world_camera(
    pose: Pose,
    cfg: CameraCfg,
    *,
    seabed_z: float = 0.0,
    altitude: float | None = None,
    roll: float = 0.0,
    pitch: float = 0.0,
) -> NDArray[np.float64]:
    """Return the transform T_c^w of Eq. 1 from the camera optical frame (x right, y down, z forward) to world ENU.

    `seabed_z` is the height of the seabed, `altitude` that of the camera above it (m; None: as configured). A positive
    roll (rad) about body x raises the left side, a positive pitch about body y lowers the nose (REP-103). Shape=(4, 4).
    """
    (cr, cp, cy), (sr, sp, sy) = ((f(roll), f(pitch), f(pose.theta)) for f in (math.cos, math.sin))
    tilt = math.radians(cfg.pitch_down_deg)
    c, s = math.cos(tilt), math.sin(tilt)
    z = seabed_z + (cfg.altitude_m if altitude is None else altitude)
    # Columns of Rz(theta) Ry(pitch) Rx(roll): forward, left, up. Scalars: numpy would take 20 us per picture.
    forward = (cy * cp, sy * cp, -sp)
    left = (cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr)
    up = (cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr)
    rows = [
        [-b, -s * a - c * d, c * a - s * d, t]
        for a, b, d, t in zip(forward, left, up, (pose.x, pose.y, z), strict=True)
    ]
    return np.array([*rows, [0.0, 0.0, 0.0, 1.0]], np.float64)


def ray_lengths(cfg: CameraCfg) -> NDArray[np.float64]:
    """Return the length of each pixel's ray at unit depth: range = depth x length. Shape=(H, W)."""
    fx, fy, cx, cy = cfg.intrinsics
    p, q = (np.arange(cfg.width) - cx) / fx, (np.arange(cfg.height) - cy) / fy
    return np.asarray(np.sqrt(1.0 + p[None, :] ** 2 + q[:, None] ** 2))


def pixel_rays(cfg: CameraCfg, roll: float = 0.0, pitch: float = 0.0) -> NDArray[np.float64]:
    """Return each pixel's ray at unit depth as its parts along the heading, to the left and up. Shape=(H, W, 3)."""
    fx, fy, cx, cy = cfg.intrinsics
    u, v = np.meshgrid((np.arange(cfg.width) - cx) / fx, (np.arange(cfg.height) - cy) / fy)
    turn = T_world_camera(Pose(0.0, 0.0, 0.0), cfg, roll=roll, pitch=pitch)[:3, :3]
    return np.asarray(np.stack([u, v, np.ones_like(u)], axis=-1) @ turn.T)


class Camera:
    """Renders a scene exactly: the result equals that of a ray caster with one ray per pixel."""

    def __init__(self, scene: Scene, cfg: CameraCfg | None = None) -> None:
        self.scene = scene
        self.cfg = cfg = cfg or CameraCfg()
        fx, fy, cx, cy = cfg.intrinsics
        self._p = (np.arange(cfg.width, dtype=np.float64) - cx) / fx
        self._q = (np.arange(cfg.height, dtype=np.float64) - cy) / fy
        self._reach = (cfg.range_m / ray_lengths(cfg)).astype(np.float32)

    def render(
        self, pose: Pose, altitude: float | None = None, *, roll: float = 0.0, pitch: float = 0.0, t: float = 0.0
    ) -> Frame:
        """Render the picture taken from a body pose at a time (s). Other arguments are those of `T_world_camera`."""
        cfg, scene = self.cfg, self.scene.at(t)
        transform = T_world_camera(pose, cfg, seabed_z=scene.seabed_z, altitude=altitude, roll=roll, pitch=pitch)
        shape = (cfg.height, cfg.width)
        frame = Frame(np.empty(shape, np.float32), np.empty(shape, np.uint8), np.empty(shape, np.int32))
        camera_kernels.render(
            transform,
            scene.seabed_z,
            cfg.near_m,
            cfg.range_m,
            self._p,
            self._q,
            self._reach,
            scene.solids,
            scene.label,
            frame.depth,
            frame.labels,
            frame.instances,
        )
        return frame
