"""One robot of a mission: a vehicle, eyes, a localizer and a pilot, in the simulator as at sea."""

from __future__ import annotations

from dataclasses import replace

from coral.reef.eyes.perception import CameraAttitude, RgbPerception, perceive_frame
from coral.reef.map.localization import Localizer
from coral.reef.map.sonar_3d15 import echoes_in_picture
from coral.reef.mission.record import PicturePose
from coral.reef.pilot.guard import Reading
from coral.reef.pilot.pilot import Command, Pilot
from coral.reef.vehicle.sensing import Vehicle, VehicleObservation
from coral.reef.vehicle.states import PilotState
from coral.reef.world.geometry import Frame, Pose


class Robot:
    """Couples a vehicle with its pilot."""

    def __init__(
        self, vehicle: Vehicle, start: Pose, pilot: Pilot, localizer: Localizer, *, eyes: RgbPerception | None = None
    ) -> None:
        """Set up; `eyes` find classes and depth in the vehicle's colour pictures, None if its pictures have them."""
        self.vehicle, self.pilot, self.belief, self.driver = vehicle, pilot, pilot.belief, pilot.driver
        self.localizer, self.pose = localizer, start
        """Where the robot believes it is: the odometry, corrected."""
        self._eyes = eyes
        self.seen = VehicleObservation(t=0.0)
        """What the vehicle measured."""
        self.reading: Reading
        """What of it can be used."""
        self._unlocated_s = 0.0
        self.odometry = start
        """Where odometry alone put the last picture."""
        self.command: Command = (0.0, 0.0)

    def sense(self, t: float) -> VehicleObservation:
        """Measure at time `t` (s)."""
        observed = self.vehicle.observe(t)
        if self._eyes is not None and observed.frame is not None:
            attitude = self.camera_attitude(observed)
            frame = perceive_frame(observed.frame.value, self._eyes, self.belief.map.camera, attitude)
            observed = replace(observed, frame=replace(observed.frame, value=frame))
        self.seen = observed
        return observed

    def camera_attitude(self, seen: VehicleObservation) -> CameraAttitude:
        """Return the camera's attitude as it is measured, with what the sonar hears in the picture."""
        attitude, layer = seen.attitude, self.belief.map.layer
        found = CameraAttitude()
        if attitude is not None:
            found = CameraAttitude(attitude.value.altitude_m, attitude.value.roll, attitude.value.pitch)
        if seen.sonar is None or layer is None:
            return found
        echoes = echoes_in_picture(seen.sonar.value, layer.sonar.pitch_down_deg, self.belief.map.camera)
        return replace(found, echoes=echoes)

    @property
    def picture(self) -> Frame | None:
        """The last picture, for the record."""
        return None if self.seen.frame is None else self.seen.frame.value

    @property
    def taken_at(self) -> PicturePose | None:
        """Where the last picture was taken, by the robot's own estimate; None if no new one reached the pilot."""
        reading, attitude = self.reading, self.seen.attitude
        if reading.frame is None or reading.frame_pose is None:
            return None
        measured = None if attitude is None else attitude.value.altitude_m
        return PicturePose(
            pose=reading.frame_pose,
            odometry=self.odometry,
            height_m=self.belief.map.camera.altitude_m if measured is None else measured,
            roll=attitude.value.roll if attitude else 0.0,
            pitch=attitude.value.pitch if attitude else 0.0,
        )

    def localize(self, dt: float) -> Pose:
        """Check the last observation, `dt` seconds after the one before, and correct its odometry."""
        reading = self.pilot.sense(self.seen)
        self._unlocated_s += dt
        if reading.frame is not None and reading.frame_pose is not None:
            before, lost = self.localizer.locate(reading.frame_pose), not self.localizer.recognised
            since_s, sees_m = self._unlocated_s, self.belief.map.sees_m
            after = self.localizer.update(reading.frame, reading.frame_pose, since_s, reading.covariance, sees_m)
            for first, end in self.localizer.mistaken:
                self.belief.look_again(first, end)
            self.belief.correct(before, after, found=lost and self.localizer.recognised > 0)
            self._unlocated_s = 0.0
        if reading.frame_pose is not None:
            self.odometry = reading.frame_pose
        if reading.pose is not None:
            locate = self.localizer.locate
            self.pose = locate(reading.pose)
            there = None if reading.frame_pose is None else locate(reading.frame_pose)
            heard = None if reading.sonar_pose is None else locate(reading.sonar_pose)
            reading = replace(reading, pose=self.pose, frame_pose=there, sonar_pose=heard)
        self.reading = reading
        return self.pose

    def think(self) -> float:
        """Choose the next command. Return the wall time spent waiting for a reply (s)."""
        clock = self.pilot.clock
        waited = clock.waited_s
        self.command = self.pilot.drive(self.reading)
        return clock.waited_s - waited

    def act(self) -> None:
        """Send the command."""
        self.vehicle.command(self.command)

    @property
    def surfaced(self) -> str:
        """Why it gave up the survey and came up, or "". The simulated vehicle keeps its depth: this ends its survey."""
        states = self.pilot.safety.states
        return f"surfaced: {states.reason}" if states.state is PilotState.SURFACING else ""
