"""A vehicle behind a link as the mission loop sees it: its reports in the survey's frame, on the survey's clock."""

from __future__ import annotations

from coral.reef.sea.frames import LocalFrame
from coral.reef.sea.latest_reading import LatestReading, LatestShot
from coral.reef.sea.link import VehicleLink, VehicleReport
from coral.reef.vehicle.response import VehicleResponse
from coral.reef.vehicle.sensing import Attitude, HeardImage, Stamped, VehicleObservation
from coral.reef.world.geometry import Pose


class LinkVehicle:
    """Puts report, newest picture and newest range image together, and sends set-points."""

    def __init__(
        self,
        link: VehicleLink,
        camera: LatestShot,
        sonar: LatestReading[HeardImage] | None,
        frame: LocalFrame,
        response: VehicleResponse,
        depth_m: float,
    ) -> None:
        """Set up; `frame` leads from the vehicle's frame to the survey's, `depth_m` is the depth to hold."""
        self.link, self.frame = link, frame
        self._camera, self._sonar, self._response, self._depth_m = camera, sonar, response, depth_m
        self.began_s = 0.0
        """Monotonic time at which the survey began."""
        self.report = VehicleReport()
        """The last report."""
        self.pose: Pose | None = None
        """The last pose by the vehicle's own odometry, in the survey's frame."""
        self.sends = True
        """Whether commands go out."""

    def observe(self, t: float) -> VehicleObservation:
        """Return what has been measured until now; stamps are those of the measurements."""
        report, began, shot = self.link.report(), self.began_s, self._camera.latest
        self.report = report
        pose = self.pose = None if report.pose is None else self.frame.to_survey(report.pose)
        heard = None if self._sonar is None else self._sonar.latest
        attitude = None
        if report.roll_rad is not None and report.pitch_rad is not None and report.depth_m is not None:
            attitude = Attitude(
                roll=report.roll_rad, pitch=report.pitch_rad, depth_m=report.depth_m, altitude_m=report.altitude_m
            )
        return VehicleObservation(
            t=t,
            pose=None if pose is None else Stamped(report.pose_stamp_s - began, pose),
            velocity=None if report.velocity is None else Stamped(report.velocity_stamp_s - began, report.velocity),
            frame=None if shot is None or shot.frame is None else Stamped(shot.stamp_s - began, shot.frame),
            covariance=None if report.covariance is None else self.frame.turned(report.covariance),
            attitude=None if attitude is None else Stamped(report.attitude_stamp_s - began, attitude),
            sonar=None if heard is None else Stamped(heard.t - began, heard.value),
        )

    def command(self, command: tuple[float, float]) -> None:
        """Send a set-point that makes the vehicle reach a speed (m/s) and a yaw rate (rad/s)."""
        if self.sends:
            self.link.command(*self._response.setpoint(*command), self._depth_m)
