import math
import time

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.ros import heard_tree, ros_camera
from coral.reef.ros.ros_camera import info_topic
from coral.reef.sea.recorded_camera import RecordedCamera
from coral.reef.vehicle.camera import CameraCfg
from coral.ros.ros_node import OtherClockError
from reef.ros.fake_ros import FakeNode, fake_type, info, message, mounted

RAW = "/front/image_raw"
SMALL = CameraCfg(width=8, height=4, hfov_deg=120.0)
LENS = {"k": [6.0, 0.0, 3.5, 0.0, 6.0, 1.5, 0.0, 0.0, 1.0], "distortion_model": "plumb_bob", "d": [-0.1] + [0.0] * 4}


@pytest.fixture(autouse=True)
def types(monkeypatch):
    for module in (ros_camera, heard_tree):
        monkeypatch.setattr(module, "ros_type", fake_type)
    for name in ("FIRST_S", "NEXT_S", "LOOK_S"):
        monkeypatch.setattr(ros_camera, name, 0.01)
    monkeypatch.setattr(ros_camera, "ALONE_S", 0.0)


class Photographed(FakeNode):
    """A picture comes as soon as somebody listens; so does the lens, and where it is mounted, if they are told."""

    def __init__(self, told=None, mount=None, pictures=True):
        super().__init__()
        self.told = {"/front/camera_info": told, "/tf_static": mount, RAW: picture() if pictures else None}
        self.publishers = {topic: int(one is not None) for topic, one in self.told.items()}

    def create_subscription(self, kind, topic, hear, qos):
        super().create_subscription(kind, topic, hear, qos)
        if self.told.get(topic) is not None:
            hear(self.told[topic])


def picture(value=7, stamp=5.0):
    data = np.full(8 * 4 * 3, value, np.uint8)
    return message(header={"stamp": stamp}, height=4, width=8, step=24, encoding="bgr8", is_bigendian=0, data=data)


def stated(**more):
    return info(**{"header": {"frame_id": "optical", "stamp": 5.0}, **more})


def camera(node, mount=SMALL, known=None):
    return ros_camera.RosCamera(RAW, 0.1, mount, known=known, node=node)


def test_the_newest_picture_is_kept():
    node = Photographed()
    found = camera(node)
    for value in (1, 2, 3):
        node.heard[RAW](picture(value))
    shot = found.read()
    assert shot.stamp_s == pytest.approx(4.9)
    assert shot.rgb.shape == (4, 8, 3)
    assert (shot.rgb == 3).all()
    with pytest.raises(OSError, match="no picture"):
        found.read()


def test_no_picture_is_one_line():
    node = Photographed(pictures=False)
    with pytest.raises(InputError, match="no picture on /front/image_raw"):
        camera(node)
    assert node.closed


def test_pictures_of_another_camera_are_one_line():
    node = Photographed()
    with pytest.raises(InputError, match=r"--camera: found /front/image_raw: pictures of 8x4 px, .* give its size"):
        camera(node, CameraCfg())
    assert node.closed


def test_a_picture_of_another_clock_counts_as_old():
    node = Photographed()
    found = camera(node)
    node.heard[RAW](picture(stamp=OtherClockError("")))
    assert found.read().stamp_s < time.monotonic() - 30.0


def test_the_topic_beside_pictures():
    assert info_topic(RAW) == info_topic(f"{RAW}/compressed") == "/front/camera_info"
    assert (info_topic("image"), info_topic("/image")) == ("camera_info", "/camera_info")


def test_the_stated_lens_rectifies_is_named_and_keeps_its_mount():
    node = Photographed(stated(**LENS))
    found = camera(node, CameraCfg(pitch_down_deg=30.0, altitude_m=1.5))
    assert (found.view.pitch_down_deg, found.view.altitude_m, found.view.width) == (30.0, 1.5, 8)
    assert found.name == "ros2:/front/image_raw, 8x4, lens of camera_info"
    node.heard["/front/camera_info"](stated(**LENS))
    node.heard[RAW](picture())
    assert found.read().rgb.shape == (found.view.height, 8, 3)
    assert found.name.endswith("lens of camera_info")


@pytest.mark.parametrize("more", [{"k": [0.0] * 9}, {"width": 0}, {"height": 0}])
def test_a_camera_that_is_not_calibrated_says_so(more):
    node = Photographed(stated(**more))
    found = camera(node)
    assert (found.view, found.name) == (SMALL, f"ros2:{RAW}, 8x4, not calibrated: no lens in camera_info")
    node.heard[RAW](picture())
    assert found.read() is not None


def test_another_lens_under_way_stops_the_pictures():
    node = Photographed()
    found = camera(node)
    assert found.view == SMALL
    node.heard["/front/camera_info"](stated())
    with pytest.raises(ValueError, match="90° across, the configuration 120°"):
        found.read()


def test_a_camera_file_counts_and_another_lens_is_told_beside_it():
    node = Photographed(stated())
    found = camera(node, known=RecordedCamera.plain(SMALL))
    node.heard[RAW](picture())
    assert found.read() is not None
    assert found.name == f"ros2:{RAW}, 8x4, camera_info says 90° across, the camera file 120°, which counts"
    assert "/tf" not in node.heard  # a busy topic, which has nothing to tell where the file does


def test_a_lens_that_cannot_be_used_is_told_at_once_or_under_way():
    broken = stated(distortion_model="unified")
    node = Photographed(broken)
    with pytest.raises(InputError, match=r"/front/camera_info: model: found 'unified'"):
        camera(node)
    assert node.closed
    node = Photographed()
    found = camera(node)
    node.heard["/front/camera_info"](broken)
    with pytest.raises(ValueError, match=r"camera_info: model: found 'unified'.*--lens"):
        found.read()


def optical(pitch_down_deg, yaw_deg=0.0):
    """Return the quaternion (x, y, z, w) of an optical frame that is turned to the left and then tilted down."""
    half_yaw, half_pitch = math.radians(yaw_deg) / 2, math.radians(pitch_down_deg) / 2
    tilt = np.array([0.0, math.sin(half_pitch), 0.0, math.cos(half_pitch)])
    return tuple(product(product((0.0, 0.0, math.sin(half_yaw), math.cos(half_yaw)), tilt), (-0.5, 0.5, -0.5, 0.5)))


def product(a, b):
    (x, y, z, w), (p, q, r, s) = a, b
    return np.array([
        w * p + x * s + y * r - z * q, w * q - x * r + y * s + z * p,
        w * r + x * q - y * p + z * s, w * s - x * p - y * q - z * r,
    ])  # fmt: skip


@pytest.mark.parametrize("pitch_deg", [0.0, 20.0, 90.0])
def test_the_tilt_is_that_of_the_optical_frame_in_the_vehicle(pitch_deg):
    mount = mounted("base_link", "optical", at=(0.2, 0.0, -0.1), turn=optical(pitch_deg))
    view = camera(Photographed(stated(), mount), CameraCfg(pitch_down_deg=33.0)).view
    assert view.pitch_down_deg == pytest.approx(pitch_deg, abs=0.01)


@pytest.mark.parametrize(("turn", "told"), [(optical(10.0, 30.0), "turned by 30 degrees"), ((0, 0, 0, 1), "by 90 deg")])
def test_a_camera_that_looks_aside_or_whose_frame_is_none_of_a_picture_is_one_line(turn, told):
    node = Photographed(stated(), mounted("base_link", "optical", turn=turn))
    with pytest.raises(InputError, match=told):
        camera(node)
    assert node.closed
