"""The simulated reef, which alone knows the truth: moves the vehicle, takes pictures, counts contacts."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Literal

import numpy as np

from coral.config import Positive
from coral.reef.map.sonar_3d15 import Sonar3d15, SonarCfg
from coral.reef.simulation.coverage import CoverageCfg, CoverageMeter
from coral.reef.simulation.daylight import PainterCfg
from coral.reef.simulation.imaging import ImagingCfg, ImagingMeter
from coral.reef.simulation.noise import PoseDrift, SensorNoise, SensorNoiseCfg
from coral.reef.simulation.stills import Stills, make_painter
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.vehicle.collision import ContactCounter, clearance
from coral.reef.vehicle.range_image import RangeImage
from coral.reef.vehicle.sensing import Attitude, VehicleObservation
from coral.reef.vehicle.vehicle import VehicleCfg, VehicleDynamics, VehicleState
from coral.reef.world.geometry import Frame, Pose
from coral.reef.world.scene import Scene
from coral.reef.world.water_types import WaterType, find_water, water_of_visibility
from coral.reef.world.world import ReefWorld


@dataclass(frozen=True, kw_only=True)
class SimulatorCfg:
    """The simulated vehicle and its sensors."""

    vehicle: VehicleCfg = field(default_factory=VehicleCfg)
    camera: CameraCfg = field(default_factory=CameraCfg)
    noise: SensorNoiseCfg = field(default_factory=SensorNoiseCfg)
    coverage: CoverageCfg = field(default_factory=CoverageCfg)
    imaging: ImagingCfg = field(default_factory=ImagingCfg)
    sonar: SonarCfg = field(default_factory=SonarCfg)
    water_depth_m: Positive = 5.0
    """Depth of the water where the world's file does not say it; only the vehicle's depth follows from it. Oyster
    reefs lie in shallow water: this is the upper end of their usual depth. No paper gives it."""
    contact: Literal["solid", "ghost"] = "solid"
    """solid: obstacles stop the hull. ghost: contacts count, but the vehicle passes through."""
    pictures: bool = False
    """Paint a colour picture of every frame."""
    stills: bool = False
    """Take colour pictures in full size, too, when a question shows them."""
    water: str = "auto"
    """Water of the colour pictures: a Jerlov type (jerlov-3C) or a preset's name. auto: the type whose visibility is
    nearest to `noise.visibility_m`."""
    painter: PainterCfg = field(default_factory=PainterCfg)

    def picture_water(self) -> WaterType:
        """Return the water of the colour pictures.

        Raises:
            InputError: There is no such water.
        """
        auto = self.water == "auto"
        return water_of_visibility(self.noise.visibility_m) if auto else find_water(self.water, "simulator.water")


class ReefSimulator:
    """Simulates the reef, one vehicle and its sensors."""

    def __init__(self, world: ReefWorld, cfg: SimulatorCfg, rng: np.random.Generator) -> None:
        """Put a vehicle at the start of a world; `rng` is the source of the sensors' noise."""
        self.world, self.cfg = world, cfg
        self.scene: Scene = Scene.from_world(world)
        self._camera = Camera(self.scene, cfg.camera)
        self._painter: Any = None
        if cfg.pictures:
            self._painter = make_painter(self.scene, cfg.camera, cfg.picture_water(), cfg.painter, world.seed)
        self._stills = make_stills(self.scene, cfg, world.seed) if cfg.stills else None
        self.taken: tuple[Pose, Frame] | None = None
        """Where the last picture was taken, and what it shows in truth: for the judge."""
        self._time_s = 0.0
        self._noise = SensorNoise(cfg.noise, rng, cfg.camera)
        self._sonar: Sonar3d15 | None = None
        if cfg.sonar.enabled:
            deep = world.water_depth_m
            surface_z = None if deep is None else world.seabed.z_m + deep
            # A stream of its own: the camera's noise is the same with and without a sonar.
            self._sonar = Sonar3d15(self.scene.resting, cfg.sonar, rng.spawn(1)[0], surface_z=surface_z)
        self._since_ping_s = math.inf
        begin = Pose(world.start.x, world.start.y, world.start.theta)
        self._drift = PoseDrift(cfg.noise, rng)
        self._footprints = self.scene.footprints()
        self._contacts = ContactCounter(self._footprints, cfg.vehicle.hull_radius_m)
        self.coverage = CoverageMeter(self.scene, seen_through_water(cfg))
        self.imaging = ImagingMeter(self.scene, cfg.camera, cfg.imaging, visibility_m=cfg.noise.visibility_m)
        self.vehicle = VehicleDynamics(cfg.vehicle, VehicleState(begin.x, begin.y, begin.theta))
        self._judge()

    @property
    def pose(self) -> Pose:
        """True pose."""
        return Pose(*self.vehicle.state[:3])

    @property
    def water_depth_m(self) -> float:
        """Depth of the water (m), as the world says or as configured."""
        return self.world.water_depth_m or self.cfg.water_depth_m

    @property
    def clearance_m(self) -> float:
        """True distance from the hull to the nearest obstacle (m); negative in contact."""
        return self._contacts.clearance(*self.pose[:2])

    def sense(self, t: float, dt: float) -> VehicleObservation:
        """Take a picture and read the navigation sensors at a time (s), `dt` seconds after the last one.

        The pose is by odometry alone, and equals the truth unless drift is on; attitude, depth and altitude have no
        error. The sonar's image is there when one is due.
        """
        u, v, r = (float(x) for x in self.vehicle.state[3:6])
        self._time_s += dt
        exact = self._camera.render(self.pose, t=self._time_s)
        frame = self._noise.apply(exact)
        self.taken = self.pose, exact
        if self._stills is not None:
            frame = self._stills.of(frame, self.pose, self._time_s)
        if self._painter is not None:
            rgb = self._painter.paint(exact, self.pose, t=self._time_s, velocity=(u, v, r))
            frame = replace(frame, rgb=rgb)
        altitude = self.cfg.camera.altitude_m
        attitude = Attitude(roll=0.0, pitch=0.0, depth_m=self.water_depth_m - altitude, altitude_m=altitude)
        sonar = self._ping(altitude, dt)
        odometry = self._drift.step(self.pose, dt)
        return VehicleObservation.at(t, odometry, (u, v, r), frame, attitude, sonar)

    def _ping(self, altitude_m: float, dt: float) -> RangeImage | None:
        """Take an image of the sonar, `dt` seconds after the last call, if one is due."""
        if self._sonar is None:
            return None
        self._since_ping_s += dt
        if self._since_ping_s < 1.0 / self.cfg.sonar.rate_hz - 1e-9:
            return None
        self._since_ping_s = 0.0
        return self._sonar.image(self.pose, altitude_m)

    def act(self, command: tuple[float, float], dt: float) -> list[tuple[float, float, int]]:
        """Drive for `dt` seconds. Return new contacts with obstacles as (x, y, index of the obstacle)."""
        current = (self.world.current.x_m_s, self.world.current.y_m_s)
        solid = self.cfg.contact == "solid"
        track = self.vehicle.step(command, dt, current, partial(clearance, self._footprints) if solid else None)
        contacts = self._contacts.follow(track)
        self._judge()
        return contacts

    def _judge(self) -> None:
        """Count the area in view now."""
        self.coverage.update(self.pose)
        self.imaging.update(self.pose)


class SimulatedVehicle:
    """The simulated vehicle as the mission loop sees it, in simulated time: a command moves it to the next tick."""

    def __init__(self, simulator: ReefSimulator, period_s: float, tell: Callable[..., None]) -> None:
        """Set up with `period_s` between two ticks; tell(event, **fields) is told of contacts."""
        self.simulator, self._period_s, self._tell = simulator, period_s, tell
        self._dt = 0.0

    def observe(self, t: float) -> VehicleObservation:
        """Measure everything at time `t` (s), one period after the last time."""
        dt, self._dt = self._dt, self._period_s
        return self.simulator.sense(t, dt)

    def command(self, command: tuple[float, float]) -> None:
        """Drive at (m/s, rad/s) for one period."""
        for x, y, obstacle in self.simulator.act(command, self._period_s):
            self._tell("collision", x=round(x, 3), y=round(y, 3), obstacle=obstacle)


def seen_through_water(cfg: SimulatorCfg) -> CoverageCfg:
    """Limit the range of coverage to the visibility."""
    limit = cfg.noise.visibility_m
    return cfg.coverage if limit is None else replace(cfg.coverage, range_m=min(cfg.coverage.range_m, limit))


def make_stills(scene: Scene, cfg: SimulatorCfg, seed: int) -> Stills:
    """Make what takes stills of a reef; `seed` is that of its world."""
    return Stills(scene, cfg.camera, cfg.picture_water(), cfg.painter, seed)
