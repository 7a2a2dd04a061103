import numpy as np
import pytest

from coral.reef.sea.frames import LocalFrame
from coral.reef.sea.latest_reading import Shot
from coral.reef.sea.link import VehicleReport
from coral.reef.sea.link_vehicle import LinkVehicle
from coral.reef.vehicle.response import VehicleResponse
from coral.reef.world.geometry import Frame, Pose

FRAME = Frame(np.zeros((2, 2), np.float32), np.zeros((2, 2), np.uint8), np.full((2, 2), -1, np.int32))


class Link:
    def __init__(self, **report):
        self.told, self.sent = VehicleReport(**report), []

    def report(self):
        return self.told

    def command(self, *setpoint):
        self.sent.append(setpoint)


class Camera:
    latest = Shot(stamp_s=101.5, frame=FRAME)


def behind(link, frame=None, response=None):
    vehicle = LinkVehicle(link, Camera(), None, frame or LocalFrame(), response or VehicleResponse(), 2.0)
    vehicle.began_s = 100.0
    return vehicle


def test_measurements_keep_their_age_on_the_surveys_clock_and_come_in_its_frame():
    turned = LocalFrame(5.0, 0.0, np.pi / 2)
    link = Link(
        pose=Pose(1.0, 0.0, 0.0), pose_stamp_s=102.0, velocity=(0.3, 0.0, 0.1), velocity_stamp_s=101.9,
        roll_rad=0.1, pitch_rad=0.2, depth_m=1.5, attitude_stamp_s=101.8, altitude_m=0.9,
        covariance=np.diag([4.0, 1.0, 0.1]),
    )  # fmt: skip
    seen = behind(link, turned).observe(2.0)
    assert seen.pose.value == pytest.approx((5.0, 1.0, np.pi / 2))
    assert (seen.pose.t, seen.frame.t) == (2.0, 1.5)
    assert seen.velocity.t == pytest.approx(1.9)
    assert (seen.attitude.value.roll, seen.attitude.value.altitude_m) == (0.1, 0.9)
    np.testing.assert_allclose(np.diag(seen.covariance), (1.0, 4.0, 0.1), atol=1e-12)


def test_what_is_not_known_is_none():
    seen = behind(Link(roll_rad=0.0)).observe(0.0)
    assert (seen.pose, seen.velocity, seen.attitude, seen.covariance, seen.sonar) == (None,) * 5


def test_commands_become_set_points_while_they_may_be_sent():
    link = Link()
    vehicle = behind(link, response=VehicleResponse(surge_gain=0.5))
    vehicle.command((0.3, 0.1))
    vehicle.sends = False
    vehicle.command((0.6, 0.0))
    assert link.sent == [(0.6, 0.1, 2.0)]
