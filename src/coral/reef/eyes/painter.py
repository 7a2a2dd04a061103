"""Paints colour pictures of the simulated reef as a camera under water would take them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.config import Fraction, NonNegative, Positive, Signed
from coral.reef.camera import CameraCfg, T_world_camera
from coral.reef.eyes import caustics
from coral.reef.eyes.ground import SeaFloor
from coral.reef.eyes.materials import Materials
from coral.reef.eyes.noise_tiles import noise_tile
from coral.reef.eyes.shading_kernels import shade
from coral.reef.eyes.water_kernels import attenuate, develop
from coral.reef.eyes.water_types import Rgb, WaterType, find_water
from coral.reef.geometry import Frame, Label, Pose
from coral.reef.scene import Scene

_INDEX = 1.34
"""Refractive index of sea water."""
_LUMA = (0.2126, 0.7152, 0.0722)


@dataclass(frozen=True, kw_only=True)
class PainterCfg:
    """Daylight, lens and sensor of the colour pictures. The daylight just below the surface is 1."""

    water_depth_m: Positive = 5.0
    """Depth of the sea floor. Oyster reefs grow from the intertidal to about 10 m."""
    sun_elevation_deg: Positive = 55.0
    """Height of the sun above the horizon, in air."""
    sun_azimuth_deg: Signed = 140.0
    """Direction of the sun in the world, counter-clockwise from +x."""
    sky_share: Fraction = 0.35
    """Share of the daylight below the surface that does not come straight from the sun."""
    wave_slope: NonNegative = 0.09
    """Root mean square slope of the waves that focus the caustics; 0 switches these off."""
    forward_blur_deg: NonNegative = 2.5
    """Standard deviation of light scattered forward: half of Petzold's scattering is within 5 degrees."""
    lens_blur_px: NonNegative = 0.5
    """Standard deviation of the lens and the pixel (px)."""
    vignette: Fraction = 0.25
    """Share of light that is lost in the corners."""
    exposure: Fraction = 0.40
    """Mean brightness that the automatic exposure aims at, on the linear scale below white."""
    white_balance: Fraction = 0.5
    """How far the automatic white balance goes towards an average of gray."""
    photons: Positive = 4000.0
    """Photons of a white pixel in daylight: the smaller, the more noise."""
    read_noise: NonNegative = 0.004
    """Standard deviation of the sensor's own noise, as a share of white."""


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
        """Prepare the surfaces of a scene.

        Args:
            scene: The solids that pictures show.
            camera: The camera that takes them.
            water: Water type, or its name.
            cfg: Daylight, lens and sensor.
            seed: Of textures, waves and noise.

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
        self.sun: tuple[float, float, float] = _refracted(self.cfg.sun_elevation_deg, self.cfg.sun_azimuth_deg)
        self._materials = Materials.of(scene, seed)
        self._ground = SeaFloor.of(scene, self.sun)
        self._tile = noise_tile(0)
        waves = self.cfg.wave_slope > 0.0
        self._film = (
            caustics.caustics(0, self.cfg.water_depth_m, self.cfg.wave_slope)
            if waves
            else np.ones((1, 1, 1), np.float32)
        )
        shape = (self.camera.height, self.camera.width, 3)
        self._surface, self._direct, self._forward = (np.empty(shape, np.float32) for _ in range(3))
        self._curve = _srgb_table()

    def paint(
        self,
        frame: Frame,
        pose: Pose,
        *,
        height: float | None = None,
        roll: float = 0.0,
        pitch: float = 0.0,
        t: float = 0.0,
    ) -> NDArray[np.uint8]:
        """Paint a frame as the camera's picture.

        Args:
            frame: What the camera's rays met.
            pose: True pose of the body.
            height: Height of the camera above the seabed (m); None: as configured.
            roll: As for `T_world_camera`.
            pitch: As for `T_world_camera`.
            t: Time (s): waves and noise move with it.

        Returns:
            Shape=(H, W, 3), RGB in sRGB.
        """
        light = self.light(frame, pose, height=height, roll=roll, pitch=pitch, t=t)
        return self._develop(light, hash((self.seed, round(t * 1e6), *(round(v * 1e6) for v in pose))) & 0x7FFFFFFF)

    def light(
        self,
        frame: Frame,
        pose: Pose,
        *,
        height: float | None = None,
        roll: float = 0.0,
        pitch: float = 0.0,
        t: float = 0.0,
    ) -> NDArray[np.float32]:
        """Return the light that reaches the lens, before exposure and noise. The arguments are those of `paint`.

        Returns:
            Shape=(H, W, 3).
        """
        cfg, water = self.cfg, self.water
        transform = T_world_camera(
            pose, self.camera, seabed_z=self.scene.seabed_z, altitude=height, roll=roll, pitch=pitch
        )
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
            self.scene.kind,
            self.scene.center,
            self.scene.half,
            self.scene.rotation,
            self._materials.kind,
            self._materials.paint,
            self._materials.fate,
            self._tile,
            self._ground.values,
            (*self._ground.origin, self._ground.cell_m),
            self._film,
            caustics.TILE_M,
            t % caustics.PERIOD_S / caustics.PERIOD_S * len(self._film),
            spread,
            self.sun,
            _scaled(floor, straight / self.sun[2]),
            _scaled(floor, 1.0 - straight),
            water.diffuse,
            (0.50, 0.44, 0.34),
            self._surface,
        )
        # Scattered evenly over the sphere: b E / (4 pi), of irradiance from above that fills about half of it.
        side = 1.0 / math.pi * 0.25
        red, green, blue = (side * b * e for b, e in zip(water.scattering, _daylight(water, above), strict=True))
        attenuate(
            np.ascontiguousarray(transform[:3, :3]),
            self._p,
            self._q,
            60.0,
            above,
            frame.depth,
            self._surface,
            water.beam,
            water.lost,
            water.diffuse,
            (red, green, blue),
            (0.5, 0.55, 0.6),
            self._direct,
            self._forward,
        )
        sigma = math.radians(cfg.forward_blur_deg) * self._focal
        return _blurred(self._direct + _blurred(self._forward, sigma), cfg.lens_blur_px)

    def _develop(self, light: NDArray[np.float32], seed: int) -> NDArray[np.uint8]:
        cfg = self.cfg
        mean = np.maximum(light.reshape(-1, 3).mean(axis=0), 1e-9)
        balance = (mean[1] / mean) ** cfg.white_balance
        gain = cfg.exposure * 0.5 / float(np.dot(_LUMA, mean * balance))
        gains = _scaled((float(balance[0]), float(balance[1]), float(balance[2])), gain)
        picture = np.empty(light.shape, np.uint8)
        develop(light, gains, cfg.vignette, cfg.photons, cfg.read_noise, seed, self._curve, picture)
        return picture


def _refracted(elevation_deg: float, azimuth_deg: float) -> tuple[float, float, float]:
    """Return the unit vector towards the sun under water (Snell's law)."""
    across = math.cos(math.radians(elevation_deg)) / _INDEX
    azimuth = math.radians(azimuth_deg)
    return across * math.cos(azimuth), across * math.sin(azimuth), math.sqrt(1.0 - across * across)


def _daylight(water: WaterType, depth_m: float) -> Rgb:
    red, green, blue = (math.exp(-k * depth_m) for k in water.diffuse)
    return red, green, blue


def _scaled(light: Rgb, by: float) -> Rgb:
    red, green, blue = (by * value for value in light)
    return red, green, blue


def _blurred(image: NDArray[np.float32], sigma: float) -> NDArray[np.float32]:
    return np.asarray(cv2.GaussianBlur(image, (0, 0), sigma), np.float32) if sigma > 0.0 else image


def _srgb_table() -> NDArray[np.uint8]:
    """Return the sRGB curve (IEC 61966-2-1) for 4096 linear values from 0 to 1."""
    x = np.linspace(0.0, 1.0, 4096)
    curve = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    return np.round(255.0 * curve).astype(np.uint8)
