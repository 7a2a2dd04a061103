"""Settings of a robustness sweep. Each of them degrades the world or the sensors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from coral.config import dotted_keys, merge, nested, to_mapping
from coral.errors import InputError, nearest
from coral.reef.drive.controllers import controller_maker
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.world.world import Current, ReefWorld

WHERE = "--sweep"
CURRENT = "current"
"""Key of the water's speed (m/s), in the direction of the world's current, or along +x if it has none."""
FASTEST_M_S = 1.0
"""Largest speed of the water, as in a world file."""
_NOISE = "simulator.noise."
SHORT: dict[str, Mapping[str, float]] = {
    "visibility": {f"{_NOISE}visibility_m": 1.0},
    "mask_errors": {
        f"{_NOISE}oyster_missed": 1.0,
        f"{_NOISE}obstacle_missed": 1.0,
        f"{_NOISE}oyster_false": 0.1,
        f"{_NOISE}obstacle_false": 0.1,
    },
    "depth_noise": {f"{_NOISE}depth_sigma": 1.0},
    "pose_drift": {
        f"{_NOISE}drift_xy": 1.0,
        f"{_NOISE}drift_theta": 0.1,
        "localization.drift_xy": 1.0,
        "localization.drift_theta": 0.1,
    },
}
"""Short words for configuration keys, each with the factor by which the word's value is multiplied.

Mask errors: of ten pixels of sea floor there is hardly one of an oyster, so false ones are ten times rarer than missed
ones. Drift: 0.1 rad for each metre, about what a heading error of that size adds over the 10 m between two places.
The robot knows how far its odometry drifts, as a data sheet says, not where to.
"""
WHAT = {
    CURRENT: "m/s: speed of the water, in the direction of the world's own current (+x in still water).",
    "visibility": "m: turbidity. Nothing is seen beyond; pixels are lost from 70 % of that range on.",
    "mask_errors": "Share of the 6 × 6 pixel patches of oysters and obstacles that are labelled as sea floor; a tenth "
    "of it is the share of sea floor labelled as each of them.",
    "depth_noise": "m/m: standard deviation of depth per metre of depth.",
    "pose_drift": "m/√s: random walk of the odometry's position, on each axis; a tenth of it, in rad/√s, of the "
    "heading. The robot knows how much it drifts, not in which direction.",
}
"""Meaning of each word."""
Overrides = Sequence[tuple[str, Any]]


def apply_setting(overrides: Overrides, cfg: MissionCfg, world: ReefWorld) -> tuple[MissionCfg, ReefWorld]:
    """Apply a setting to mission and world. Without overrides, return the same objects.

    Args:
        overrides: Pairs of a key and its JSON value: `current`, a word of `SHORT`, or a dotted configuration key.
        cfg: Configuration of the nominal mission.
        world: World as loaded.

    Raises:
        InputError: A key is unknown (the message names the nearest one) or a value is bad.
    """
    for key, value in overrides:
        if key == CURRENT:
            world = _with_current(world, value)
            continue
        cfg = merge(cfg, nested(_keys(key, value, cfg), WHERE), WHERE)
        if key == "driver":
            controller_maker(cfg.driver, WHERE, key)
    return cfg, world


def _keys(key: str, value: Any, cfg: MissionCfg) -> dict[str, Any]:
    """Return the dotted keys that a setting changes, with their values."""
    if key in SHORT:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(WHERE, key, repr(value), "a number")
        return {name: factor * value for name, factor in SHORT[key].items()}
    known = dotted_keys(to_mapping(cfg))
    if key not in known:
        words = [CURRENT, *SHORT]
        same_end = [name for name in known if name.rsplit(".", 1)[-1] == key]
        hint = f" (did you mean {same_end[0]!r}?)" if same_end else nearest(key, [*words, *known])
        raise InputError(WHERE, key, "an unknown key", f"{', '.join(words)}, or a key of the configuration{hint}")
    return {key: value}


def _with_current(world: ReefWorld, speed: Any) -> ReefWorld:
    if isinstance(speed, bool) or not isinstance(speed, int | float) or not 0.0 <= speed <= FASTEST_M_S:
        raise InputError(WHERE, CURRENT, repr(speed), f"a speed between 0 and {FASTEST_M_S:g} m/s")
    now = world.current
    size = math.hypot(now.x_m_s, now.y_m_s)
    x, y = (now.x_m_s / size, now.y_m_s / size) if size else (1.0, 0.0)
    return world.model_copy(update={"current": Current(x_m_s=speed * x, y_m_s=speed * y)})
