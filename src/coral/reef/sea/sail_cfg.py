"""The configuration of a survey in real time."""

from __future__ import annotations

from dataclasses import dataclass, field

from coral.config import Positive
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.sea.safety import SafetyCfg
from coral.reef.vehicle.response import VehicleResponse


@dataclass(frozen=True, kw_only=True)
class SailCfg:
    """What a survey in real time needs besides a mission's configuration."""

    mission: MissionCfg = field(default_factory=MissionCfg)
    safety: SafetyCfg = field(default_factory=SafetyCfg)
    depth_m: Positive = 1.0
    """Depth to hold."""
    response: VehicleResponse | None = None
    """How the vehicle follows its set-points, as `coral reef identify` measured it; None: as the simulated one does."""
