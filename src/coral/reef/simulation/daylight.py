"""Daylight, lens and sensor of the colour pictures, and where the sun stands under water."""

from __future__ import annotations

import math
from dataclasses import dataclass

from coral.config import Fraction, NonNegative, Positive, Signed

_INDEX = 1.34
"""Refractive index of sea water."""


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
    snow: NonNegative = 1.0
    """Marine snow: times 60 particles in a cubic metre of water that scatters 1/m; 0 switches it off."""
    shutter_s: NonNegative = 0.01
    """Time that the shutter is open."""
    lens_blur_px: NonNegative = 0.5
    """Standard deviation of the lens and the pixel (px)."""
    vignette: Fraction = 0.25
    """Share of light that is lost in the corners."""
    exposure: Fraction = 0.20
    """Mean that the automatic exposure aims at, as a share of white, linear: 0.2 is 48 % on the curve of sRGB."""
    white_balance: Fraction = 0.5
    """How far the automatic white balance goes towards an average of gray."""
    photons: Positive = 12000.0
    """Photons of a white pixel in daylight: the smaller, the more noise."""
    read_noise: NonNegative = 0.004
    """Standard deviation of the sensor's own noise, as a share of white."""


def sun_direction(cfg: PainterCfg) -> tuple[float, float, float]:
    """Return the unit vector towards the sun under water, in the world (Snell's law)."""
    across = math.cos(math.radians(cfg.sun_elevation_deg)) / _INDEX
    azimuth = math.radians(cfg.sun_azimuth_deg)
    return across * math.cos(azimuth), across * math.sin(azimuth), math.sqrt(1.0 - across * across)
