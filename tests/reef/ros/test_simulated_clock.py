"""Camera and sonar of a simulator, whose clock is far from ours, over real DDS."""

import array
import time
from contextlib import contextmanager

import numpy as np
import pytest

from coral.reef.map.sonar_3d15 import SonarCfg
from coral.reef.ros import ros_sonar
from coral.reef.ros.ros_camera import RosCamera
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.vehicle.sensing import Stamped
from coral.ros.ros_node import OLD_S, RosNode

pytestmark = pytest.mark.ros2
SMALL = CameraCfg(width=8, height=4)
BEGUN = 100.0
"""The simulation's time when it begins (s)."""


@contextmanager
def simulator():
    """Publish /clock, pictures and points, all stamped by the simulation's own time."""
    from builtin_interfaces.msg import Time
    from rosgraph_msgs.msg import Clock
    from sensor_msgs.msg import Image, PointCloud2, PointField

    ros = RosNode("simulator", "/clocked", "--vehicle")
    clock, image = ros.node.create_publisher(Clock, "/clock", 10), ros.node.create_publisher(Image, "camera/image", 1)
    cloud, zero = ros.node.create_publisher(PointCloud2, "ranges", 1), time.monotonic() - BEGUN
    fields = [PointField(name=name, offset=4 * k, datatype=7, count=1) for k, name in enumerate("xyz")]

    def publish():
        now = time.monotonic() - zero
        stamp = Time(sec=int(now), nanosec=int(now % 1.0 * 1e9))
        clock.publish(Clock(clock=stamp))
        picture = Image(height=4, width=8, step=24, encoding="rgb8", data=array.array("B", bytes(96)))
        points = PointCloud2(height=1, width=1, point_step=12, row_step=12, fields=fields)
        points.data = array.array("B", np.array([3.0, 0.0, 0.0], "<f4").tobytes())
        picture.header.stamp, points.header.stamp, points.header.frame_id = stamp, stamp, "base_link"
        image.publish(picture)
        cloud.publish(points)

    ros.node.create_timer(0.05, publish)
    try:
        yield
    finally:
        ros.close()


def age_of(source):
    """Return the age of what a source tells after a while, when it has heard of the clock (s)."""
    try:
        end = time.monotonic() + 3.0
        while time.monotonic() < end:
            found = source.read()
        return time.monotonic() - (found.t if isinstance(found, Stamped) else found.stamp_s)
    finally:
        source.close()


@pytest.mark.parametrize(("with_clock", "oldest_s"), [(True, 0.5), (False, OLD_S + 1.0)])
def test_what_is_seen_and_heard_is_as_old_as_it_is_by_the_simulators_clock(tmp_path, monkeypatch, with_clock, oldest_s):
    monkeypatch.setattr(ros_sonar, "SEEN", 0.0)
    file = tmp_path / "vehicle.yaml"
    file.write_text(f"/**:\n  ros__parameters:\n    use_sim_time: {str(with_clock).lower()}\n")
    with simulator():
        seen = age_of(RosCamera("/clocked/camera/image", 0.0, SMALL, str(file)))
        heard = age_of(ros_sonar.RosSonar("/clocked/ranges", SonarCfg(), str(file)))
    for age_s in (seen, heard):
        assert oldest_s - 1.0 < age_s < oldest_s


def test_a_topic_without_a_slash_is_in_the_vehicles_namespace():
    with simulator():
        camera = RosCamera("camera/image", 0.0, SMALL, "/clocked")
        assert "8x4" in camera.name
        camera.close()
