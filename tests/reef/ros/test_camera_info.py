import math

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.ros import camera_info, heard_tree
from coral.reef.ros.camera_info import info_topic, stated_camera
from coral.reef.vehicle.camera import CameraCfg
from reef.ros.fake_ros import FakeNode, fake_type, info, mounted

RAW = "/front/image_raw"
WIDE = {"distortion_model": "plumb_bob", "d": [-0.3, 0.1, 0.001, 0.002, 0.0]}


@pytest.fixture(autouse=True)
def types(monkeypatch):
    for module in (camera_info, heard_tree):
        monkeypatch.setattr(module, "ros_type", fake_type)
    for name in ("FIRST_S", "LOOK_S"):
        monkeypatch.setattr(camera_info, name, 0.01)
    monkeypatch.setattr(camera_info, "ALONE_S", 0.0)


class Stating(FakeNode):
    """A camera that states its lens, and where it is mounted, when somebody listens; None for one that is silent."""

    def __init__(self, told=None, pictures=1, mount=None):
        super().__init__()
        self.told = {"/front/camera_info": told, "/tf_static": mount}
        self.publishers = {RAW: pictures, **{topic: int(one is not None) for topic, one in self.told.items()}}

    def create_subscription(self, kind, topic, hear, qos):
        if self.told.get(topic) is not None:
            hear(self.told[topic])


def test_the_topic_beside_pictures():
    assert info_topic(RAW) == info_topic(f"{RAW}/compressed") == "/front/camera_info"


@pytest.mark.parametrize("more", [{"k": [0.0] * 9}, {"width": 0}, {"height": 0}])
def test_a_camera_without_calibration_has_no_lens(more):
    assert stated_camera(RAW, CameraCfg(), node=Stating(info(**more))) is None


def test_the_stated_camera_rectifies_and_keeps_its_mount():
    k = [300.0, 0.0, 320.0, 0.0, 300.0, 240.0, 0.0, 0.0, 1.0]
    node = Stating(info(**WIDE, width=640, height=480, k=k))
    camera = stated_camera(RAW, CameraCfg(pitch_down_deg=30.0, altitude_m=1.5), node=node)
    assert (camera.view.pitch_down_deg, camera.view.altitude_m, camera.view.width) == (30.0, 1.5, 320)
    assert camera.picture(np.zeros((480, 640, 3), np.uint8)).shape == (camera.view.height, 320, 3)
    with pytest.raises(ValueError, match="320x240"):
        camera.picture(np.zeros((240, 320, 3), np.uint8))
    assert node.closed


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
    node = Stating(info(), mount=mounted("base_link", "optical", at=(0.2, 0.0, -0.1), turn=optical(pitch_deg)))
    view = stated_camera(RAW, CameraCfg(pitch_down_deg=33.0), node=node).view
    assert view.pitch_down_deg == pytest.approx(pitch_deg, abs=0.01)


@pytest.mark.parametrize(("turn", "told"), [(optical(10.0, 30.0), "turned by 30 degrees"), ((0, 0, 0, 1), "by 90 deg")])
def test_a_camera_that_looks_aside_or_whose_frame_is_none_of_a_picture_is_one_line(turn, told):
    node = Stating(info(), mount=mounted("base_link", "optical", turn=turn))
    with pytest.raises(InputError, match=told):
        stated_camera(RAW, CameraCfg(), node=node)
    assert node.closed


def test_pictures_without_a_lens_beside_them_have_none():
    assert stated_camera(RAW, CameraCfg(), node=Stating()) is None


def test_a_topic_without_pictures_is_one_line():
    with pytest.raises(InputError, match="no picture on /front/image_raw"):
        stated_camera(RAW, CameraCfg(), node=Stating(pictures=0))


def test_a_lens_that_cannot_be_used_is_one_line():
    with pytest.raises(InputError, match=r"/front/camera_info: model: found 'unified'"):
        stated_camera(RAW, CameraCfg(), node=Stating(info(distortion_model="unified")))
