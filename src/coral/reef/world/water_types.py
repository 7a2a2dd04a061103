"""Optical water types: absorption, scattering and diffuse attenuation in the camera's three colours."""

from __future__ import annotations

from dataclasses import dataclass

from coral.errors import InputError, nearest

Rgb = tuple[float, float, float]

FORWARD_SHARE = 0.5
"""Share of scattering within about 5 degrees of the forward direction: half, in Petzold's measurements of sea water
(Mobley, Light and Water, 1994, section 3.8). This light is not lost to a picture, but blurs it."""
BLACK_DISC = 4.8
"""A black disc disappears at the range 4.8 / c, c at the wavelength that the eye sees best (Zaneveld and Pegau, Robust
underwater visibility parameter, Optics Express 11(23), 2003)."""


@dataclass(frozen=True, kw_only=True)
class WaterType:
    """Inherent and apparent optical properties of one water, for the channels red, green and blue (1/m)."""

    name: str
    absorption: Rgb
    scattering: Rgb
    diffuse: Rgb
    """Diffuse attenuation K_d of daylight on its way down."""

    @property
    def beam(self) -> Rgb:
        """Beam attenuation c = a + b: the law of Beer and Lambert for light that keeps its direction."""
        a, b = self.absorption, self.scattering
        return a[0] + b[0], a[1] + b[1], a[2] + b[2]

    @property
    def lost(self) -> Rgb:
        """Attenuation without what is scattered forward: a + (1 - `FORWARD_SHARE`) b."""
        a, b, rest = self.absorption, self.scattering, 1.0 - FORWARD_SHARE
        return a[0] + rest * b[0], a[1] + rest * b[1], a[2] + rest * b[2]

    @property
    def visibility_m(self) -> float:
        """Horizontal range at which a black disc disappears (m)."""
        return BLACK_DISC / self.beam[1]


def _jerlov(name: str, absorption: Rgb, scattering: Rgb, diffuse: Rgb) -> WaterType:
    return WaterType(name=f"jerlov-{name}", absorption=absorption, scattering=scattering, diffuse=diffuse)


JERLOV: dict[str, WaterType] = {
    water.name: water
    for water in (
        _jerlov("I", (0.309, 0.053, 0.009), (0.001, 0.002, 0.004), (0.305, 0.063, 0.019)),
        _jerlov("IA", (0.309, 0.054, 0.014), (0.002, 0.004, 0.007), (0.310, 0.067, 0.026)),
        _jerlov("IB", (0.309, 0.054, 0.015), (0.045, 0.054, 0.070), (0.315, 0.072, 0.036)),
        _jerlov("II", (0.310, 0.054, 0.016), (0.270, 0.365, 0.516), (0.335, 0.089, 0.068)),
        _jerlov("III", (0.310, 0.056, 0.031), (0.737, 0.998, 1.413), (0.375, 0.120, 0.135)),
        _jerlov("1C", (0.316, 0.067, 0.105), (0.274, 0.372, 0.526), (0.370, 0.120, 0.250)),
        _jerlov("3C", (0.508, 0.052, 0.161), (0.904, 1.071, 1.532), (0.400, 0.190, 0.390)),
        _jerlov("5C", (0.430, 0.222, 0.216), (1.090, 1.382, 1.857), (0.480, 0.300, 0.560)),
        _jerlov("7C", (0.351, 0.188, 0.574), (1.772, 2.394, 3.376), (0.540, 0.460, 0.890)),
        _jerlov("9C", (0.398, 0.349, 0.995), (2.347, 3.180, 4.496), (0.650, 0.630, 1.600)),
    )
}
"""From the clearest ocean to the most turbid coast.

Absorption and scattering: Solonenko and Mobley, Inherent optical properties of Jerlov water types, Applied Optics
54(17), 2015, for red, green and blue as given by Droske et al., Path Tracing in Production: The Path of Water,
SIGGRAPH 2023 courses. Red of 5C differs from that table (4.638 and 3.589): absorption cannot exceed the diffuse
attenuation by so much, so it is the mean of its neighbours 3C and 7C, and its scattering has their mean proportion to
green.
Diffuse attenuation: Jerlov, Marine Optics, 1976, table XXVII, at 625, 550 and 450 nm."""

ALIASES = {"clear": "jerlov-IB", "pool": "jerlov-IB", "coast": "jerlov-1C", "bay": "jerlov-3C", "hard": "jerlov-5C"}
"""Waters of the presets of a mission: visibility 44 m, 10.9 m, 4.3 m and 3.0 m, where the presets say none, 11 m, 4.5 m
and 3 m."""


def find_water(name: str, where: str = "water") -> WaterType:
    """Return a water type by its name, `jerlov-3C` or `3C`, or by the name of a preset.

    Raises:
        InputError: There is none of this name.
    """
    known = {key.casefold(): water for key, water in JERLOV.items()}
    known |= {key.removeprefix("jerlov-"): water for key, water in known.items()}
    known |= {alias: JERLOV[key] for alias, key in ALIASES.items()}
    found = known.get(name.casefold())
    if found is None:
        names = [*ALIASES, *JERLOV]
        raise InputError(where, "", repr(name), f"one of {', '.join(names)}{nearest(name, names)}")
    return found


def water_of_visibility(visibility_m: float | None) -> WaterType:
    """Return the coastal water type whose visibility is nearest to a mission's; that of `clear` without a limit."""
    if visibility_m is None:
        return find_water("clear")
    coastal = [water for water in JERLOV.values() if water.name.endswith("C")]
    return min(coastal, key=lambda water: abs(water.visibility_m - visibility_m))
