"""The lens that a camera states, over real DDS."""

from contextlib import contextmanager

import pytest

from coral.reef.ros.ros_camera import RosCamera
from coral.reef.vehicle.camera import CameraCfg
from coral.ros.ros_node import RosNode

pytestmark = pytest.mark.ros2
SMALL = CameraCfg(width=64, height=48)
K = [300.0, 0.0, 320.0, 0.0, 301.0, 240.0, 0.0, 0.0, 1.0]


@contextmanager
def camera(**stated):
    """Publish pictures, and their lens if one is stated."""
    from sensor_msgs.msg import CameraInfo, Image

    ros = RosNode("camera", "/stating", "--camera")
    image = ros.node.create_publisher(Image, "image_raw", 1)
    picture = Image(width=640, height=480, step=640, encoding="mono8", data=bytes(640 * 480))
    ros.node.create_timer(0.1, lambda: image.publish(picture))
    if stated:
        info = ros.node.create_publisher(CameraInfo, "camera_info", ros.qos("sensor"))
        ros.node.create_timer(0.1, lambda: info.publish(CameraInfo(**stated)))
    try:
        yield
    finally:
        ros.close()


def view(**stated):
    """Return the camera that is found beside pictures, configured at 640x480."""
    with camera(**stated):
        found = RosCamera("/stating/image_raw", 0.0, SMALL)
        try:
            return found.view
        finally:
            found.close()


def test_a_stated_lens_is_used():
    found = view(width=640, height=480, distortion_model="plumb_bob", d=[-0.3, 0.1, 0.0, 0.0, 0.0], k=K)
    assert found.width == 320
    assert 80.0 < found.hfov_deg < 119.0


@pytest.mark.parametrize("stated", [{}, {"width": 640, "height": 480}])
def test_a_camera_that_is_not_calibrated_has_none(stated):
    assert view(**stated) == SMALL
