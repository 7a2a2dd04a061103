import time

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.ros import ros_camera
from coral.reef.ros.camera_info import camera_of
from coral.reef.vehicle.camera import CameraCfg
from coral.ros.ros_node import OtherClockError
from reef.ros.fake_ros import FakeNode, fake_type, info, message


@pytest.fixture(autouse=True)
def types(monkeypatch):
    monkeypatch.setattr(ros_camera, "ros_type", fake_type)
    monkeypatch.setattr(ros_camera, "FIRST_S", 0.01)
    monkeypatch.setattr(ros_camera, "NEXT_S", 0.01)


class Photographed(FakeNode):
    """A picture comes as soon as somebody listens."""

    def create_subscription(self, kind, topic, hear, qos):
        super().create_subscription(kind, topic, hear, qos)
        if not topic.endswith("info"):
            hear(picture())


def picture(value=7, stamp=5.0):
    data = np.full(8 * 4 * 3, value, np.uint8)
    return message(header={"stamp": stamp}, height=4, width=8, step=24, encoding="bgr8", is_bigendian=0, data=data)


SMALL = CameraCfg(width=8, height=4, hfov_deg=120.0)


def camera(node, view=SMALL, **more):
    return ros_camera.RosCamera("/front/image_raw", 0.1, lambda rgb: rgb, view, node=node, **more)


def test_the_newest_picture_is_kept(capsys):
    node = Photographed()
    found = camera(node)
    for value in (1, 2, 3):
        node.heard["/front/image_raw"](picture(value))
    shot = found.read()
    assert shot.stamp_s == pytest.approx(4.9)
    assert shot.rgb.shape == (4, 8, 3)
    assert (shot.rgb == 3).all()
    with pytest.raises(OSError, match="no picture"):
        found.read()


def test_no_picture_is_one_line():
    with pytest.raises(InputError, match="no picture on /front/image_raw"):
        camera(FakeNode())


def test_a_picture_of_another_clock_counts_as_old():
    node = Photographed()
    found = camera(node)
    node.heard["/front/image_raw"](picture(stamp=OtherClockError("")))
    assert found.read().stamp_s < time.monotonic() - 30.0


def test_a_lens_that_disagrees_is_told():
    node = Photographed()
    found = camera(node)
    node.heard["/front/camera_info"](info())
    with pytest.raises(ValueError, match="90° across, the configuration 120°"):
        found.read()


def test_a_camera_file_counts_and_another_lens_is_told_beside_it():
    node = Photographed()
    found = camera(node, from_file=True)
    node.heard["/front/camera_info"](info())
    assert found.name == ("ros2:/front/image_raw, 8x4, camera_info says 90° across, the camera file 120°, which counts")
    node.heard["/front/image_raw"](picture())
    assert found.read() is not None


def test_the_lens_that_is_used_is_named():
    node = Photographed()
    found = camera(node, camera_of(info(), "/front/image_raw", SMALL).view)
    node.heard["/front/camera_info"](info())
    assert found.name == "ros2:/front/image_raw, 8x4, lens of camera_info"


@pytest.mark.parametrize("more", [{"k": [0.0] * 9}, {"width": 0}, {"height": 0}])
def test_a_camera_that_is_not_calibrated_says_so(more):
    node = Photographed()
    found = camera(node)
    node.heard["/front/camera_info"](info(**more))
    assert found.name == "ros2:/front/image_raw, 8x4, not calibrated: no lens in camera_info"
    node.heard["/front/image_raw"](picture())
    assert found.read() is not None


def test_a_lens_of_an_unknown_model_is_told():
    node = Photographed()
    found = camera(node)
    node.heard["/front/camera_info"](info(distortion_model="unified"))
    with pytest.raises(ValueError, match=r"camera_info: model: found 'unified'.*--lens"):
        found.read()
