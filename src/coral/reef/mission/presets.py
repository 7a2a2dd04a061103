"""What a mission's conditions are: water and sensors by name, from clear to hard, and single keys of a sweep."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from coral.config import dotted_keys, merge, nested, to_mapping
from coral.errors import InputError, nearest
from coral.reef.drive.controllers import controller_maker
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.world.world import Current, ReefWorld

NOISE = "simulator.noise."
WHERE, SWEEP = "--preset", "--sweep"
CURRENT = "current"
"""Key of the water's speed (m/s), in the direction of the world's current, or along +x if it has none."""
FASTEST_M_S = 1.0
"""Largest speed of the water, as in a world file."""


class Condition(NamedTuple):
    """One value of a preset."""

    key: str
    """A key of the configuration, or `current`: the speed of the water in the direction that the world gives it."""
    value: float
    reason: str


@dataclass(frozen=True, kw_only=True)
class Preset:
    """Water and sensors."""

    what: str
    """For help texts and tables."""
    conditions: tuple[Condition, ...] = ()
    """What differs from the default configuration and the world's file."""

    @property
    def values(self) -> dict[str, float]:
        """Value by key."""
        return {condition.key: condition.value for condition in self.conditions}


def _mask_errors(missed: float, reason: str) -> list[Condition]:
    """Return that a share of patches is missed; of ten pixels of sea floor there is hardly one of an oyster."""
    false = round(0.1 * missed, 6)
    shares = {"oyster_missed": missed, "obstacle_missed": missed, "oyster_false": false, "obstacle_false": false}
    return [Condition(f"{NOISE}{key}", share, reason) for key, share in shares.items()]


def _drift(drift_xy: float, reason: str) -> list[Condition]:
    """Return a drift (m/√s) that the robot knows, as a data sheet says, with 0.1 rad of heading for each metre.

    A heading error of that size adds about as much over the 10 m between two places.
    """
    drifts = {"drift_xy": drift_xy, "drift_theta": round(0.1 * drift_xy, 6)}
    return [Condition(f"{of}{key}", d, reason) for of in (NOISE, "localization.") for key, d in drifts.items()]


def _small_water() -> tuple[Condition, ...]:
    """The lengths of a survey for the paper's pool of 3.66 m, where those for reefs of 20 to 30 m see nothing left."""
    survey = "planner.survey."
    return (
        Condition("planner.separation_m", 0.5, "heaps of shells lie 1 m apart, not 3 m"),
        Condition(f"{survey}cell_m", 0.1, "two map cells: passages are 0.8 m wide"),
        Condition(f"{survey}min_region_m2", 0.15, "a heap is 0.3 m²: half of one may be hidden"),
        Condition(f"{survey}min_frontier_m", 0.3, "the width of the vehicle's hull radius"),
        Condition(f"{survey}tile_m", 1.0, "a third of the tank"),
        Condition(f"{survey}gain_radius_m", 1.0, "a third of the tank"),
        Condition(f"{survey}border_m", 0.2, "the tank's wall is nearer to the border than 0.5 m"),
        Condition(f"{survey}look_m", 1.5, "balls and walls hide what is farther away"),
        Condition(f"{survey}reef_reach_m", 2.0, "half of the tank"),
        Condition(f"{survey}ahead_m", 2.0, "half of the tank"),
    )


CLEAR = "clear"
PRESETS: dict[str, Preset] = {
    CLEAR: Preset(what="the paper's simulation: clear water, perfect sensors, the current of the world's file"),
    "coast": Preset(
        what="a clear coast: 11 m of visibility, and less of everything that `bay` has",
        conditions=(
            Condition(
                f"{NOISE}visibility_m",
                11.0,
                "Jerlov 1C: beyond what is told apart at any distance in `clear`, but with colours lost",
            ),
            *_mask_errors(0.02, "less than half of `bay`: 2 % missed, 0.2 % false"),
            Condition(f"{NOISE}depth_sigma", 0.01, "half of `bay`"),
            *_drift(0.01, "half of `bay`: 0.3 m after ten minutes on average"),
            Condition(CURRENT, 0.1, "as in `bay`: what is hard here is to see, not to drive"),
        ),
    ),
    "bay": Preset(
        what="a calm bay: 4.5 m of visibility, a few wrong masks, depth noise, slow drift, a weak current",
        conditions=(
            Condition(
                f"{NOISE}visibility_m", 4.5, "between the 6 m of the paper's sensing range and the 3 m of `hard`"
            ),
            *_mask_errors(0.05, "half of `hard`: 5 % missed, 0.5 % false"),
            Condition(f"{NOISE}depth_sigma", 0.02, "0.02 m at 1 m: smaller than the map's cells of 0.05 m up to 2.5 m"),
            *_drift(
                0.02,
                "0.6 m after ten minutes on average: less than d_merge (1 m), so tracks stay apart",
            ),
            Condition(CURRENT, 0.1, "a sixth of the cruise speed; shipped reefs have 0.003 to 0.07 m/s"),
        ),
    ),
    "hard": Preset(
        what="murky water, poor masks and a drifting position: 3 m of visibility, 10 % missed, 1 % false",
        conditions=(
            Condition(
                f"{NOISE}visibility_m",
                3.0,
                "half of the paper's sensing range, and as near as `visited` means by default",
            ),
            *_mask_errors(
                0.1,
                "10 % of the patches missed, and 1 % of the sea floor taken for oysters or obstacles each",
            ),
            Condition(f"{NOISE}depth_sigma", 0.03, "0.09 m at the limit of visibility: two cells"),
            *_drift(
                0.06,
                "1.8 m after ten minutes on average: more than d_merge, so that it has to be corrected",
            ),
            Condition(CURRENT, 0.1, "as in `bay`: what is hard here is to see, not to drive"),
        ),
    ),
    "pool": Preset(
        what="clear water in a tank of a few metres: what counts as unexplored is as small as the place",
        conditions=_small_water(),
    ),
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
    return f"{first}. {'; '.join(f'{name}: {preset.what}' for name, preset in PRESETS.items())}. --cfg flags win."


def apply_setting(
    overrides: Sequence[tuple[str, Any]], cfg: MissionCfg, world: ReefWorld
) -> tuple[MissionCfg, ReefWorld]:
    """Apply a setting to mission and world. Without overrides, return the same objects.

    Args:
        overrides: Pairs of a key and its JSON value: `current`, or a dotted configuration key.
        cfg: Configuration of the nominal mission.
        world: World as loaded.

    Raises:
        InputError: A key is unknown (the message names the nearest one) or a value is bad.
    """
    for key, value in overrides:
        if key == CURRENT:
            world = _with_current(world, value)
            continue
        known = dotted_keys(to_mapping(cfg))
        if key not in known:
            same_end = [name for name in known if name.rsplit(".", 1)[-1] == key]
            hint = f" (did you mean {same_end[0]!r}?)" if same_end else nearest(key, [CURRENT, *known])
            raise InputError(SWEEP, key, "an unknown key", f"{CURRENT}, or a key of the configuration{hint}")
        cfg = merge(cfg, nested({key: value}, SWEEP), SWEEP)
        if key == "driver":
            controller_maker(cfg.driver, SWEEP, key)
    return cfg, world


def _with_current(world: ReefWorld, speed: Any) -> ReefWorld:
    if isinstance(speed, bool) or not isinstance(speed, int | float) or not 0.0 <= speed <= FASTEST_M_S:
        raise InputError(SWEEP, CURRENT, repr(speed), f"a speed between 0 and {FASTEST_M_S:g} m/s")
    now = world.current
    size = math.hypot(now.x_m_s, now.y_m_s)
    x, y = (now.x_m_s / size, now.y_m_s / size) if size else (1.0, 0.0)
    return world.model_copy(update={"current": Current(x_m_s=speed * x, y_m_s=speed * y)})
