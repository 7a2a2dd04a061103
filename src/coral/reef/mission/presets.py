"""Water and sensors by name: what a mission's conditions are, from clear water to hard ones."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

from coral.errors import InputError, nearest
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.sweep import CURRENT, apply_setting
from coral.reef.world.world import ReefWorld

NOISE = "simulator.noise."
WHERE = "--preset"


@dataclass(frozen=True, kw_only=True)
class Condition:
    """One value of a preset."""

    key: str
    """A key of the configuration, or `current`: the speed of the water in the direction that the world gives it."""
    value: float
    reason: str


@dataclass(frozen=True, kw_only=True)
class Preset:
    """Water and sensors."""

    name: str
    what: str
    """For help texts and tables."""
    conditions: tuple[Condition, ...] = ()
    """What differs from the default configuration and the world's file."""

    @property
    def values(self) -> dict[str, float]:
        """Value by key."""
        return {condition.key: condition.value for condition in self.conditions}


def _masks(missed: float, reason: str) -> tuple[Condition, ...]:
    """Wrong masks of oysters and obstacles alike; false ones are ten times rarer, as in a sweep of `mask_errors`."""
    keys = {"oyster_missed": missed, "obstacle_missed": missed, "oyster_false": missed / 10}
    keys["obstacle_false"] = missed / 10
    return tuple(Condition(key=f"{NOISE}{key}", value=round(value, 6), reason=reason) for key, value in keys.items())


def _drift(xy: float, reason: str) -> tuple[Condition, ...]:
    """Random walk of position and heading, in the proportion of a sweep of `pose_drift`; the robot is told how much."""
    told = "the robot's odometry is calibrated: it knows how much it drifts, not where to"
    return (
        Condition(key="localization.drift_xy", value=xy, reason=told),
        Condition(key="localization.drift_theta", value=round(xy / 10, 6), reason=told),
        Condition(key=f"{NOISE}drift_xy", value=xy, reason=reason),
        Condition(key=f"{NOISE}drift_theta", value=round(xy / 10, 6), reason=reason),
    )


def _small_water() -> tuple[Condition, ...]:
    """The lengths of a survey for the paper's pool of 3.66 m, where those for reefs of 20 to 30 m see nothing left."""
    survey = "planner.survey."
    return (
        Condition(key="planner.separation_m", value=0.5, reason="heaps of shells lie 1 m apart, not 3 m"),
        Condition(key=f"{survey}cell_m", value=0.1, reason="two map cells: passages are 0.8 m wide"),
        Condition(key=f"{survey}min_region_m2", value=0.15, reason="a heap is 0.3 m²: half of one may be hidden"),
        Condition(key=f"{survey}min_frontier_m", value=0.3, reason="the width of the vehicle's hull radius"),
        Condition(key=f"{survey}tile_m", value=1.0, reason="a third of the tank"),
        Condition(key=f"{survey}gain_radius_m", value=1.0, reason="a third of the tank"),
        Condition(key=f"{survey}border_m", value=0.2, reason="the tank's wall is nearer to the border than 0.5 m"),
        Condition(key=f"{survey}look_m", value=1.5, reason="balls and walls hide what is farther away"),
        Condition(key=f"{survey}reef_reach_m", value=2.0, reason="half of the tank"),
        Condition(key=f"{survey}ahead_m", value=2.0, reason="half of the tank"),
    )


CLEAR = "clear"
PRESETS: dict[str, Preset] = {
    preset.name: preset
    for preset in (
        Preset(
            name=CLEAR, what="the paper's simulation: clear water, perfect sensors, the current of the world's file"
        ),
        Preset(
            name="coast",
            what="a clear coast: 11 m of visibility, and less of everything that `bay` has",
            conditions=(
                Condition(
                    key=f"{NOISE}visibility_m",
                    value=11.0,
                    reason="Jerlov 1C: beyond what is told apart at any distance in `clear`, but with colours lost",
                ),
                *_masks(0.02, "less than half of `bay`: 2 % missed, 0.2 % false"),
                Condition(key=f"{NOISE}depth_sigma", value=0.01, reason="half of `bay`"),
                *_drift(0.01, "half of `bay`: 0.3 m after ten minutes on average"),
                Condition(key=CURRENT, value=0.1, reason="as in `bay`: what is hard here is to see, not to drive"),
            ),
        ),
        Preset(
            name="bay",
            what="a calm bay: 4.5 m of visibility, a few wrong masks, depth noise, slow drift, a weak current",
            conditions=(
                Condition(
                    key=f"{NOISE}visibility_m",
                    value=4.5,
                    reason="between the 6 m of the paper's sensing range and the 3 m of `hard`",
                ),
                *_masks(0.05, "half of `hard`: 5 % missed, 0.5 % false"),
                Condition(
                    key=f"{NOISE}depth_sigma",
                    value=0.02,
                    reason="0.02 m at 1 m: smaller than the map's cells of 0.05 m up to 2.5 m",
                ),
                *_drift(0.02, "0.6 m after ten minutes on average: less than d_merge (1 m), so tracks stay apart"),
                Condition(
                    key=CURRENT, value=0.1, reason="a sixth of the cruise speed; shipped reefs have 0.003 to 0.07 m/s"
                ),
            ),
        ),
        Preset(
            name="hard",
            what="murky water, poor masks and a drifting position: 3 m of visibility, 10 % missed, 1 % false",
            conditions=(
                Condition(
                    key=f"{NOISE}visibility_m",
                    value=3.0,
                    reason="half of the paper's sensing range, and as near as `visited` means by default",
                ),
                *_masks(
                    0.1, "10 % of the patches missed, and 1 % of the sea floor taken for oysters or obstacles each"
                ),
                Condition(key=f"{NOISE}depth_sigma", value=0.03, reason="0.09 m at the limit of visibility: two cells"),
                *_drift(0.06, "1.8 m after ten minutes on average: more than d_merge, so that it has to be corrected"),
                Condition(key=CURRENT, value=0.1, reason="as in `bay`: what is hard here is to see, not to drive"),
            ),
        ),
        Preset(
            name="pool",
            what="clear water in a tank of a few metres: what counts as unexplored is as small as the place",
            conditions=_small_water(),
        ),
    )
}
"""clear, coast, bay and hard in order of difficulty: no value of one is easier than that of the one before."""


def named(name: str) -> Preset:
    """Return a preset.

    Raises:
        InputError: There is none of this name.
    """
    if name not in PRESETS:
        raise InputError(WHERE, "", repr(name), f"one of {', '.join(PRESETS)}{nearest(name, PRESETS)}")
    return PRESETS[name]


def apply_preset(
    name: str, cfg: MissionCfg, world: ReefWorld, keep: Collection[str] = ()
) -> tuple[MissionCfg, ReefWorld]:
    """Put a mission into the water of a preset; `clear` returns the very same objects.

    Raises:
        InputError: There is no such preset.
    """
    chosen: list[tuple[str, Any]] = [(key, value) for key, value in named(name).values.items() if key not in keep]
    return apply_setting(chosen, cfg, world)


def preset_help(first: str) -> str:
    """Return the help of a flag that takes a preset: the command's own words, then the presets and what they are."""
    return f"{first}. {'; '.join(f'{preset.name}: {preset.what}' for preset in PRESETS.values())}. --cfg flags win."
