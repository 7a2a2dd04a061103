"""The oracle's tour of a world, planned once and cached in this process and in the user's cache folder."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.config import to_mapping
from coral.disk_cache import code_stamp, recall
from coral.reef.mission.oracle import plan_tour
from coral.reef.simulation.imaging import ImagingCfg
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.vehicle.vehicle import VehicleCfg
from coral.reef.world.world import ReefWorld

SHARE = 0.9
"""Of what is inspected when the tour counts as done (`oracle_ratio_90`)."""


@dataclass(frozen=True)
class Bound:
    """The cached part of a tour."""

    time_s: float | None
    """Time at which `SHARE` is inspected (s). None: never."""
    commands: NDArray[np.float64]
    """Shape=(K, 2), forward speed (m/s) and yaw rate (rad/s) of each tick."""


@lru_cache(maxsize=64)
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
    inspected or the package has changed.
    """
    asked = {
        "world": world.model_dump(mode="json"),
        "camera": to_mapping(camera),
        "imaging": to_mapping(imaging),
        "visibility_m": visibility_m,
        "vehicle": [vehicle.hull_radius_m, vehicle.max_speed_m_s, vehicle.max_yaw_rate_rad_s],
        "dt": dt,
        "share": SHARE,
    }
    key = hashlib.sha256(json.dumps(asked, sort_keys=True).encode()).hexdigest()[:24]

    def plan() -> dict[str, Any]:
        tour = plan_tour(world, camera, imaging, visibility_m, vehicle, dt)
        return {"time_s": tour.time_to(SHARE), "commands": tour.commands.tolist()}

    found = recall(f"oracle-{key}", code_stamp(), plan)
    return Bound(found["time_s"], np.array(found["commands"], np.float64).reshape(-1, 2))
