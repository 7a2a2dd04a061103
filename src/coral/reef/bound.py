"""The oracle's times for a world, planned once and kept: in this process, and in the user's cache folder."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from functools import lru_cache
from pathlib import Path

from coral.config import to_mapping
from coral.reef.camera import CameraCfg
from coral.reef.imaging import ImagingCfg
from coral.reef.oracle import plan_tour
from coral.reef.vehicle import VehicleCfg
from coral.reef.world import ReefWorld

SHARES = (0.5, 0.8, 0.9)
_CODE = (
    "oracle",
    "stops",
    "tour_kernels",
    "imaging",
    "imaging_kernels",
    "costfield",
    "costfield_kernels",
    "reachability",
)
"""Modules whose text decides the tour."""

Bound = dict[str, float | None]


def oracle_times(
    world: ReefWorld,
    camera: CameraCfg,
    imaging: ImagingCfg,
    visibility_m: float | None,
    vehicle: VehicleCfg,
) -> Bound:
    """When the oracle's tour has inspected 50, 80 and 90 % (`50`, `80`, `90`), and all that it will (`end`); seconds.

    Deterministic. Planned anew only when the world, the camera, what counts as inspected or the planner has changed.
    """
    asked = {
        "world": world.model_dump(mode="json"),
        "camera": to_mapping(camera),
        "imaging": to_mapping(imaging),
        "visibility_m": visibility_m,
        "vehicle": [vehicle.hull_radius_m, vehicle.max_speed_m_s, vehicle.max_yaw_rate_rad_s],
        "code": _code(),
    }
    key = hashlib.sha256(json.dumps(asked, sort_keys=True).encode()).hexdigest()[:24]
    if key in _kept:
        return _kept[key]
    path = _folder() / f"{key}.json"
    with contextlib.suppress(OSError, ValueError):
        _kept[key] = json.loads(path.read_text(encoding="utf-8"))
        return _kept[key]
    tour = plan_tour(world, camera, imaging, visibility_m=visibility_m, vehicle=vehicle)
    found: Bound = {f"{100 * share:.0f}": tour.time_to(share) for share in SHARES}
    found["end"] = round(tour.dt * len(tour.commands), 3)
    _kept[key] = found
    with contextlib.suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_name(f".{path.name}.{os.getpid()}.part")
        part.write_text(json.dumps(found), encoding="utf-8")
        os.replace(part, path)
    return found


_kept: dict[str, Bound] = {}


def _folder() -> Path:
    root = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(root) / "coral" / "oracle"


@lru_cache(maxsize=1)
def _code() -> str:
    here = Path(__file__).parent
    return hashlib.sha256(b"".join((here / f"{name}.py").read_bytes() for name in _CODE)).hexdigest()[:12]
