"""The oracle's tour of a world, planned once and cached in this process and in the user's cache folder."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.config import to_mapping
from coral.file_writer import write_whole
from coral.foreign_file import read_bytes, read_json
from coral.limits import YAML_BYTES
from coral.reef.mission.oracle import plan_tour
from coral.reef.simulation.imaging import ImagingCfg
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.vehicle.vehicle import VehicleCfg
from coral.reef.world.world import ReefWorld

SHARE = 0.9
"""Of what is inspected when the tour counts as done (`oracle_ratio_90`)."""
_CODE = (
    "mission/oracle",
    "pilot/stops",
    "vehicle/tour_kernels",
    "simulation/imaging",
    "simulation/imaging_kernels",
    "vehicle/camera",
    "map/costfield",
    "map/costfield_kernels",
    "world/reachability",
    "world/scene",
)
"""Modules that determine the tour: a change of their text invalidates the cache."""


@dataclass(frozen=True)
class Bound:
    """The cached part of a tour."""

    time_s: float | None
    """Time at which `SHARE` is inspected (s). None: never."""
    commands: NDArray[np.float64]
    """Shape=(K, 2), forward speed (m/s) and yaw rate (rad/s) of each tick."""


def oracle_bound(
    world: ReefWorld,
    camera: CameraCfg,
    imaging: ImagingCfg,
    visibility_m: float | None,
    vehicle: VehicleCfg,
    dt: float = 0.1,
) -> Bound:
    """Return the oracle's tour and its time. The arguments are those of `plan_tour`.

    Deterministic. The tour is planned again only if the world, the camera, the vehicle, the water, the definition of
    inspected or the planner has changed.
    """
    asked = {
        "world": world.model_dump(mode="json"),
        "camera": to_mapping(camera),
        "imaging": to_mapping(imaging),
        "visibility_m": visibility_m,
        "vehicle": [vehicle.hull_radius_m, vehicle.max_speed_m_s, vehicle.max_yaw_rate_rad_s],
        "dt": dt,
        "share": SHARE,
        "code": _code(),
    }
    key = hashlib.sha256(json.dumps(asked, sort_keys=True).encode()).hexdigest()[:24]
    if key in _kept:
        return _kept[key]
    path = _folder() / f"{key}.json"
    with contextlib.suppress(OSError, ValueError, KeyError, TypeError, AttributeError):
        content: Any = read_json(path, "a tour")
        time_s = None if content["time_s"] is None else float(content["time_s"])
        _kept[key] = Bound(time_s, np.array(content["commands"], np.float64).reshape(-1, 2))
        return _kept[key]
    tour = plan_tour(world, camera, imaging, visibility_m=visibility_m, vehicle=vehicle, dt=dt)
    found = _kept[key] = Bound(tour.time_to(SHARE), tour.commands)
    with contextlib.suppress(OSError):
        write_whole(path, json.dumps({"time_s": found.time_s, "commands": found.commands.tolist()}))
    return found


_kept: dict[str, Bound] = {}


def _folder() -> Path:
    root = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(root) / "coral" / "oracle"


@lru_cache(maxsize=1)
def _code() -> str:
    here = Path(__file__).parents[1]
    code = [read_bytes(here / f"{name}.py", "a module", YAML_BYTES) for name in _CODE]
    return hashlib.sha256(b"".join(code)).hexdigest()[:12]
