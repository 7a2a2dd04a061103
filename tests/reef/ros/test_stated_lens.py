"""The lens that a camera states, over real DDS."""

from contextlib import contextmanager

import pytest

from coral.reef.ros.camera_info import stated_camera
from coral.reef.vehicle.camera import CameraCfg
from coral.ros.ros_node import RosNode

pytestmark = pytest.mark.ros2
K = [300.0, 0.0, 320.0, 0.0, 301.0, 240.0, 0.0, 0.0, 1.0]


@contextmanager
def camera(**stated):
    """Publish pictures, and their lens if one is stated."""
    from sensor_msgs.msg import CameraInfo, Image

    ros = RosNode("camera", "/stating", "--camera")
    image = ros.node.create_publisher(Image, "image_raw", 1)
    ros.node.create_timer(0.1, lambda: image.publish(Image()))
    if stated:
        info = ros.node.create_publisher(CameraInfo, "camera_info", ros.qos("sensor"))
        ros.node.create_timer(0.1, lambda: info.publish(CameraInfo(**stated)))
    try:
        yield
    finally:
        ros.close()


def test_a_stated_lens_is_used():
    with camera(width=640, height=480, distortion_model="plumb_bob", d=[-0.3, 0.1, 0.0, 0.0, 0.0], k=K):
        found = stated_camera("/stating/image_raw", CameraCfg())
    assert found.size == (640, 480)
    assert found.rectifier is not None
    assert 80.0 < found.view.hfov_deg < 120.0


@pytest.mark.parametrize("stated", [{}, {"width": 640, "height": 480}])
def test_a_camera_that_is_not_calibrated_has_none(stated):
    with camera(**stated):
        assert stated_camera("/stating/image_raw", CameraCfg()) is None
