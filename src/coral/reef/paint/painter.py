"""Paints colour pictures of the simulated reef as a camera under water would take them."""

from __future__ import annotations

import math
from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.reef.paint import caustics
from coral.reef.paint.motion_kernels import blur_motion
from coral.reef.paint.shading_kernels import shade
from coral.reef.paint.snow_kernels import CELL_M, draw_snow
from coral.reef.paint.surface_kernels import SAND
from coral.reef.paint.surfaces import Materials, SeaFloor, noise_tile
from coral.reef.paint.water_kernels import attenuate, develop, transmission_table
from coral.reef.simulation.daylight import PainterCfg, sun_direction
from coral.reef.vehicle.camera import CameraCfg, T_world_camera
from coral.reef.world.geometry import Frame, Label, Pose
from coral.reef.world.scene import Scene
from coral.reef.world.water_types import Rgb, WaterType, find_water

_RANGES = 1024
"""Rows of the table of transmissions."""
_FAR_M = 80.0
"""Range at which open water ends in a picture: even in the clearest water the veil is complete by then."""
_SIDE, _EVEN, _AGAIN = 0.5, 0.03, 0.008
"""The veil's sources, as shares of scattering: the half that leaves the forward direction, of sun and sky by its angle;
sunlight that was scattered on its way down, and light scattered many times, from everywhere (1/sr). The last two are
fitted by eye to pictures by Cycles."""
_LUMA = (0.2126, 0.7152, 0.0722)


class Painter:
    """Paints what `Camera` has ray cast: the same geometry, in colours. Deterministic in seed, pose and time."""

    def __init__(
        self,
        scene: Scene,
        camera: CameraCfg | None = None,
        water: WaterType | str = "clear",
        cfg: PainterCfg | None = None,
        seed: int = 0,
    ) -> None:
        """Prepare the surfaces of a scene for pictures of a camera; `seed` is of textures, waves and noise.

        Raises:
            InputError: There is no water of this name.
        """
        self.scene, self.camera, self.cfg = scene, camera or CameraCfg(), cfg or PainterCfg()
        self.water = find_water(water) if isinstance(water, str) else water
        self.seed = seed
        fx, fy, cx, cy = self.camera.intrinsics
        self._p = (np.arange(self.camera.width, dtype=np.float64) - cx) / fx
        self._q = (np.arange(self.camera.height, dtype=np.float64) - cy) / fy
        self._focal = fx
        self.sun: tuple[float, float, float] = sun_direction(self.cfg)
        self._materials = Materials.of(scene, seed)
        self._ground = SeaFloor.of(scene.resting, self.sun)
        self._tile = noise_tile(0)
        self._table = np.empty((_RANGES, 6), np.float32)
        self._near = 1.01 * self.camera.range_m
        transmission_table(self.water.beam, self.water.lost, self._near, self._table)
        shape = (self.camera.height, self.camera.width, 3)
        self._surface, self._direct, self._forward = (np.empty(shape, np.float32) for _ in range(3))

    def paint(
        self,
        frame: Frame,
        pose: Pose,
        *,
        roll: float = 0.0,
        pitch: float = 0.0,
        t: float = 0.0,
        velocity: tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> NDArray[np.uint8]:
        """Paint what the camera's rays met as its picture, RGB in sRGB. Shape=(H, W, 3).

        Roll and pitch as for `T_world_camera`, at the camera's configured height above the seabed.
        Waves, snow, noise and animals change with `t` (s). Velocity, surge, sway (m/s) and yaw rate (rad/s), blurs.
        """
        light = self.light(frame, pose, roll=roll, pitch=pitch, t=t, velocity=velocity)
        return expose(light, self.cfg, noise_seed(self.seed, pose, t))

    def light(
        self,
        frame: Frame,
        pose: Pose,
        *,
        roll: float = 0.0,
        pitch: float = 0.0,
        t: float = 0.0,
        velocity: tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> NDArray[np.float32]:
        """Return the light that reaches the lens, before exposure and noise, as for `paint`. Shape=(H, W, 3)."""
        cfg, water, scene = self.cfg, self.water, self.scene.at(t)
        transform = T_world_camera(pose, self.camera, seabed_z=self.scene.seabed_z, roll=roll, pitch=pitch)
        above = max(cfg.water_depth_m - float(transform[2, 3] - self.scene.seabed_z), 0.0)
        floor = _daylight(water, cfg.water_depth_m)
        # Scattering on the way down takes light from the straight beam and spreads the caustics.
        spread = math.exp(-0.25 * water.scattering[1] * cfg.water_depth_m)
        straight = (1.0 - cfg.sky_share) * max(spread, 0.15)
        shade(
            transform,
            self.scene.seabed_z,
            self._p,
            self._q,
            1.0 / self._focal,
            frame.depth,
            frame.instances,
            frame.labels == Label.SEABED,
            scene.solids,
            self._materials.kind,
            self._materials.paint,
            self._materials.fate,
            self._tile,
            self._ground.values,
            (*self._ground.origin, self._ground.cell_m),
            self._waves(t),
            caustics.TILE_M,
            0.75 * spread,
            self.sun,
            _scaled(floor, straight / self.sun[2] / math.pi),
            _scaled(floor, (1.0 - straight) / math.pi),
            water.diffuse,
            SAND,
            self._surface,
        )
        lost_sun = 1.0 - cfg.sky_share - straight
        attenuate(
            np.ascontiguousarray(transform[:3, :3]),
            self._p,
            self._q,
            self._near,
            _FAR_M,
            above,
            frame.depth,
            self._surface,
            self._table,
            water.lost,
            water.diffuse,
            _product(water.scattering, _daylight(water, above)),
            water.scattering,
            self.sun,
            (_SIDE * straight, _SIDE * cfg.sky_share, _EVEN * lost_sun + _AGAIN * min(1.0, water.scattering[1])),
            self._direct,
            self._forward,
        )
        image = self._direct + _blurred(self._forward, math.radians(cfg.forward_blur_deg) * self._focal)
        if cfg.snow > 0.0:
            self._draw_snow(image, transform, frame.depth, t, _scaled(_daylight(water, above), 1.0 / math.pi))
        if any(velocity):
            image = self._blur_motion(image, frame.depth, velocity)
        return _blurred(image, cfg.lens_blur_px)

    def _waves(self, t: float) -> NDArray[np.float32]:
        """Return the caustics at a time: between two frames of the film."""
        if self.cfg.wave_slope == 0.0:
            return np.ones((1, 1), np.float32)
        film = caustics.caustics(0, self.cfg.water_depth_m, self.cfg.wave_slope)
        at = t % caustics.PERIOD_S / caustics.PERIOD_S * len(film)
        share = np.float32(at - int(at))
        now, then = film[int(at) % len(film)], film[(int(at) + 1) % len(film)]
        return np.asarray((1 - share) * now + share * then, np.float32)

    def _draw_snow(
        self,
        image: NDArray[np.float32],
        transform: NDArray[np.float64],
        depth: NDArray[np.float32],
        t: float,
        light: Rgb,
    ) -> None:
        """Add particles: as many as the water scatters light."""
        per_m3 = 60.0 * self.cfg.snow * self.water.scattering[1]
        draw_snow(
            transform,
            self._focal,
            self.camera.intrinsics[2:],
            (0.03 * t, 0.02 * t, -0.004 * t),
            self.scene.seabed_z,
            min(per_m3 * CELL_M**3, 1.0),
            light,
            self.water.lost,
            self.seed & 0x7FFFFFFF,
            depth,
            image,
        )

    def _blur_motion(
        self, image: NDArray[np.float32], depth: NDArray[np.float32], velocity: tuple[float, float, float]
    ) -> NDArray[np.float32]:
        """Blur what moves while the shutter is open; roll and pitch rates are left out."""
        surge, sway, rate = (self.cfg.shutter_s * v for v in velocity)
        tilt = math.radians(self.camera.pitch_down_deg)
        c, s = math.cos(tilt), math.sin(tilt)
        # Body forward, left and up in the camera's right, down and forward.
        shift, turn = np.array([-sway, -s * surge, c * surge]), np.array([0.0, -c * rate, -s * rate])
        blurred = np.empty_like(image)
        blur_motion(self._focal, self._p, self._q, shift, turn, depth, image, blurred)
        return blurred


def _daylight(water: WaterType, depth_m: float) -> Rgb:
    red, green, blue = (math.exp(-k * depth_m) for k in water.diffuse)
    return red, green, blue


def _product(a: Rgb, b: Rgb) -> Rgb:
    return a[0] * b[0], a[1] * b[1], a[2] * b[2]


def _scaled(light: Rgb, by: float) -> Rgb:
    red, green, blue = (by * value for value in light)
    return red, green, blue


def _blurred(image: NDArray[np.float32], sigma: float) -> NDArray[np.float32]:
    return np.asarray(cv2.GaussianBlur(image, (0, 0), sigma), np.float32) if sigma > 0.0 else image


def expose(light: NDArray[np.float32], cfg: PainterCfg, seed: int) -> NDArray[np.uint8]:
    """Take the picture, RGB in sRGB, of the light that reaches the lens, linear, on any scale. Shape=(H, W, 3) both.

    Exposure and white balance follow from this picture alone, so a picture does not depend on those before it.
    """
    mean = np.maximum(light.reshape(-1, 3).mean(axis=0, dtype=np.float64), 1e-9)
    balance = (mean[1] / mean) ** cfg.white_balance
    gain = cfg.exposure / float(np.dot(_LUMA, mean * balance))
    red, green, blue = (float(gain * b) for b in balance)
    picture = np.empty(light.shape, np.uint8)
    develop(light, (red, green, blue), cfg.vignette, cfg.photons, cfg.read_noise, seed, srgb_table(), picture)
    return picture


def noise_seed(seed: int, pose: Pose, t: float) -> int:
    """Return the seed of one picture's noise: another one for every pose and time."""
    return hash((seed, round(t * 1e6), *(round(v * 1e6) for v in pose))) & 0x7FFFFFFF


@cache
def srgb_table() -> NDArray[np.uint8]:
    """Return the sRGB curve (IEC 61966-2-1) for 4096 linear values from 0 to 1."""
    x = np.linspace(0.0, 1.0, 4096)
    curve = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    return np.round(255.0 * curve).astype(np.uint8)
