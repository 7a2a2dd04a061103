import time

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.ros import ros_camera
from coral.reef.vehicle.camera import CameraCfg
from coral.ros_node import OtherClockError
from reef.ros.fake_ros import FakeNode, fake_type, message


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


def camera(node, lens=None):
    return ros_camera.RosCamera("/front/image_raw", 0.1, lambda rgb: rgb, lens, node=node)


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
    found = camera(node, CameraCfg(width=8, height=4, hfov_deg=120.0))
    node.heard["/front/camera_info"](message(k=[4.0, 0.0, 4.0, 0, 4.0, 2.0, 0, 0, 1], width=8))
    with pytest.raises(ValueError, match="90° across, the configuration 120°"):
        found.read()
