"""Settings of a robustness sweep. Each of them degrades the world or the sensors."""

from __future__ import annotations

import math
from collections.abc import Sequence
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
Overrides = Sequence[tuple[str, Any]]


def apply_setting(overrides: Overrides, cfg: MissionCfg, world: ReefWorld) -> tuple[MissionCfg, ReefWorld]:
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
            raise InputError(WHERE, key, "an unknown key", f"{CURRENT}, or a key of the configuration{hint}")
        cfg = merge(cfg, nested({key: value}, WHERE), WHERE)
        if key == "driver":
            controller_maker(cfg.driver, WHERE, key)
    return cfg, world


def _with_current(world: ReefWorld, speed: Any) -> ReefWorld:
    if isinstance(speed, bool) or not isinstance(speed, int | float) or not 0.0 <= speed <= FASTEST_M_S:
        raise InputError(WHERE, CURRENT, repr(speed), f"a speed between 0 and {FASTEST_M_S:g} m/s")
    now = world.current
    size = math.hypot(now.x_m_s, now.y_m_s)
    x, y = (now.x_m_s / size, now.y_m_s / size) if size else (1.0, 0.0)
    return world.model_copy(update={"current": Current(x_m_s=speed * x, y_m_s=speed * y)})
