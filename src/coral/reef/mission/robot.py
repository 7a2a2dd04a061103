"""One robot of a mission: a vehicle with its sensors in the simulated reef, and the pilot that drives it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from coral.advisor.clock import SimulatedClock
from coral.reef.drive.local_planner import LocalPlanner
from coral.reef.eyes.perception import RgbPerception, perceive_frame
from coral.reef.map.belief import Belief
from coral.reef.map.echo_points import echoes_in_picture
from coral.reef.map.localization import Localizer
from coral.reef.mission.record import PicturePose
from coral.reef.pilot.guard import Reading
from coral.reef.pilot.pilot import Command, Pilot
from coral.reef.simulation.faults import FaultySensors
from coral.reef.simulation.simulator import ReefSimulator, Sensed
from coral.reef.vehicle.fleet import Neighbour
from coral.reef.vehicle.sensing import Stamped, VehicleObservation
from coral.reef.vehicle.states import PilotState
from coral.reef.world.geometry import Frame, Pose

Build = Callable[["Robot"], Pilot]
"""Builds the pilot of a robot."""


class Robot:
    """Couples a simulated vehicle with its pilot."""

    def __init__(
        self,
        number: int,
        simulator: ReefSimulator,
        belief: Belief,
        localizer: Localizer,
        driver: LocalPlanner,
        clock: SimulatedClock,
        emit: Callable[..., None],
        build: Build,
        alone: bool,
        faults: FaultySensors | None = None,
        eyes: RgbPerception | None = None,
    ) -> None:
        self.number, self.simulator, self.belief, self.driver, self.clock = number, simulator, belief, driver, clock
        self.localizer, self.pose = localizer, simulator.pose
        """Where the robot believes it is: the odometry, corrected. It knows its start."""
        self._emit, self._alone = emit, alone
        self.sensed: Sensed | None = None
        """What the simulator measured, before any fault."""
        self.faults, self._eyes = faults or FaultySensors(()), eyes
        self.seen: VehicleObservation
        """What reached the pilot."""
        self._reading: Reading
        self._unlocated_s = 0.0
        self._odometry = self.pose
        self.command: Command = (0.0, 0.0)
        self.pilot = build(self)

    def emit(self, event: str, **fields: Any) -> None:
        """Emit an event, with the number of the robot if it is not alone."""
        self._emit(event, **(fields if self._alone else {"robot": self.number, **fields}))

    def sense(self, t: float, dt: float) -> VehicleObservation:
        """Measure at time `t` (s), `dt` seconds after the last time. Faults that are due spoil what is measured."""
        sensed = self.simulator.sense(dt)
        if self._eyes is not None:
            camera, attitude = self.simulator.cfg.camera, self.simulator.camera_attitude
            if sensed.sonar is not None:
                tilt = self.simulator.cfg.sonar.pitch_down_deg
                attitude = replace(attitude, echoes=echoes_in_picture(sensed.sonar, tilt, camera))
            sensed = replace(sensed, frame=perceive_frame(sensed.frame, self._eyes, camera, attitude))
        self.sensed = sensed
        seen = VehicleObservation.at(t, sensed.pose, sensed.velocity, sensed.frame, sensed.attitude, sensed.sonar)
        if sensed.covariance is not None:
            measured = Stamped(t - sensed.velocity_age_s, sensed.velocity)
            seen = replace(seen, covariance=sensed.covariance, velocity=measured)
        self.seen = self.faults.apply(seen)
        return self.seen

    @property
    def picture(self) -> Frame:
        """The last picture, as it reached the pilot if it is one of this camera, for the record."""
        assert self.sensed is not None
        exact, seen = self.sensed.frame, self.seen.frame
        return seen.value if seen is not None and seen.value.depth.shape == exact.depth.shape else exact

    @property
    def taken_at(self) -> PicturePose | None:
        """Where the last picture was taken, by the robot's own estimate; None if no new one reached the pilot."""
        assert self.sensed is not None
        reading, attitude = self._reading, self.seen.attitude
        if reading.frame is None or reading.frame_pose is None:
            return None
        return PicturePose(
            pose=reading.frame_pose,
            odometry=self._odometry,
            height_m=self._height_m(),
            roll=attitude.value.roll if attitude else 0.0,
            pitch=attitude.value.pitch if attitude else 0.0,
        )

    def _height_m(self) -> float:
        """Return the camera's height above the sea floor as it is measured, or as configured (m)."""
        attitude = self.seen.attitude
        measured = None if attitude is None else attitude.value.altitude_m
        return self.simulator.cfg.camera.altitude_m if measured is None else measured

    def localize(self, dt: float) -> Pose:
        """Check the last observation, `dt` seconds after the one before, and correct its odometry."""
        reading = self.pilot.sense(self.seen)
        self._unlocated_s += dt
        if reading.frame is not None and reading.frame_pose is not None:
            self.localizer.update(reading.frame, reading.frame_pose, self._unlocated_s, reading.covariance)
            self._unlocated_s = 0.0
        if reading.frame_pose is not None:
            self._odometry = reading.frame_pose
        if reading.pose is not None:
            locate = self.localizer.locate
            self.pose = locate(reading.pose)
            there = None if reading.frame_pose is None else locate(reading.frame_pose)
            heard = None if reading.sonar_pose is None else locate(reading.sonar_pose)
            reading = replace(reading, pose=self.pose, frame_pose=there, sonar_pose=heard)
        self._reading = reading
        return self.pose

    def think(self, others: Iterable[Neighbour]) -> float:
        """Choose the next command. Return the wall time spent waiting for a reply (s)."""
        waited, self.belief.others = self.clock.waited_s, tuple(others)
        self.command = self.pilot.drive(self._reading)
        return self.clock.waited_s - waited

    def act(self, dt: float, others: Iterable[tuple[float, float]]) -> None:
        """Drive for `dt` seconds among robots at the positions `others` (m)."""
        for x, y, obstacle in self.simulator.act(self.command, dt, tuple(others)):
            self.emit("collision", x=round(x, 3), y=round(y, 3), obstacle=obstacle)

    def says(self) -> Neighbour:
        """Return what it tells the other robots."""
        about, plan, belief = self.pilot, self.pilot.plan, self.belief
        busy = not about.end_reason
        path, times = (np.empty((0, 2)), np.empty(0)) if plan is None else (plan.path[:, :2], plan.times)
        return Neighbour(
            pose=self.pose,
            radius_m=self.simulator.cfg.vehicle.hull_radius_m,
            goal=belief.goal if busy else None,
            index=belief.goal_index if busy else None,
            later=frozenset(g.index for g in about.route.goals[1:] if g.index is not None) if busy else frozenset(),
            path=path,
            times=times,
        )

    @property
    def surfaced(self) -> str:
        """Why it gave up the survey and came up, or "". The simulated vehicle keeps its depth: this ends its survey."""
        states = self.pilot.safety.states
        return f"surfaced: {states.reason}" if states.state is PilotState.SURFACING else ""

    @property
    def position(self) -> tuple[float, float]:
        """True position (m)."""
        x, y, _ = self.simulator.pose
        return x, y
