import math
import struct

import cv2
import numpy as np
import pytest

from coral.contact.real_scenes.cameras.bag_camera import BagRgbdCamera
from coral.errors import InputError

pytest.importorskip("rosbags")
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_HUMBLE)
TYPES = STORE.types
DEPTH, COLOUR = "/camera/aligned_depth_to_color/image_raw", "/camera/color/image_raw"
INFO = "/camera/aligned_depth_to_color/camera_info"


def header(time_s):
    stamp = TYPES["builtin_interfaces/msg/Time"](sec=int(time_s), nanosec=round(1e9 * (time_s % 1)))
    return TYPES["std_msgs/msg/Header"](stamp=stamp, frame_id="camera")


def image(time_s, pixels, encoding):
    raw = np.frombuffer(np.ascontiguousarray(pixels).tobytes(), np.uint8)
    height, width = pixels.shape[:2]
    kind = TYPES["sensor_msgs/msg/Image"]
    return kind(header(time_s), height, width, encoding, 0, raw.size // height, raw)


def camera_info(time_s, fx=60.0, model="plumb_bob", d=(0.0,) * 5):
    roi = TYPES["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, False)
    k = np.array([fx, 0, 31.5, 0, 60.0, 23.5, 0, 0, 1.0])
    kind = TYPES["sensor_msgs/msg/CameraInfo"]
    return kind(header(time_s), 48, 64, model, np.array(d), k, np.eye(3).ravel(), np.zeros(12), 0, 0, roi)


def write(path, messages):
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        known = {}
        for topic, time_s, message in messages:
            if topic not in known:
                known[topic] = writer.add_connection(topic, message.__msgtype__, typestore=STORE)
            writer.write(known[topic], round(1e9 * time_s), STORE.serialize_cdr(message, message.__msgtype__))
    return path


def two_pictures(colour_shape=(48, 64)):
    near, far = np.full((48, 64), 800, np.uint16), np.full((48, 64), 900, np.uint16)
    red = np.zeros((*colour_shape, 3), np.uint8)
    red[..., 2] = 255
    return [
        (INFO, 1.0, camera_info(1.0)),
        (DEPTH, 1.0, image(1.0, near, "16UC1")),
        (COLOUR, 1.01, image(1.0, red, "bgr8")),  # the colours of a picture may come after its depth
        (DEPTH, 1.1, image(1.1, far, "16UC1")),
    ]


def test_depth_is_paired_with_its_colours(tmp_path):
    camera = BagRgbdCamera(str(write(tmp_path / "bag", two_pictures())))
    camera.start()
    first, second = camera.newest(), camera.newest()
    assert camera.newest() is None
    assert (first.time_s, second.time_s) == pytest.approx((1.0, 1.1))
    assert (first.depth[0, 0], second.depth[0, 0]) == pytest.approx((0.8, 0.9))
    assert first.rgb[0, 0].tolist() == [255, 0, 0]
    assert second.rgb is None  # the only colours are 0.1 s old
    assert first.names == ()


def test_depth_in_metres_with_gaps(tmp_path):
    depth = np.full((48, 64), 0.7, np.float32)
    depth[0, 0] = np.nan
    messages = [(INFO, 1.0, camera_info(1.0)), (DEPTH, 1.0, image(1.0, depth, "32FC1"))]
    camera = BagRgbdCamera(str(write(tmp_path / "bag", messages)))
    camera.start()
    assert camera.newest().depth[0, :2].tolist() == pytest.approx([0.0, 0.7])


def test_depth_that_is_not_aligned_is_refused(tmp_path):
    camera = BagRgbdCamera(str(write(tmp_path / "bag", two_pictures(colour_shape=(24, 32)))))
    with pytest.raises(InputError, match="depth aligned to the colours"):
        camera.start()


@pytest.mark.parametrize(
    ("rest", "told"),
    [
        ("{}#depht=/x", "did you mean 'depth'"),
        ("{}#depth=/x", "no such topic"),
        ("{}/nowhere", "--camera"),
    ],
)
def test_a_wrong_word_is_one_line(tmp_path, rest, told):
    path = write(tmp_path / "bag", two_pictures())
    with pytest.raises(InputError, match=told):
        BagRgbdCamera(rest.format(path))


def test_two_depth_topics_are_named(tmp_path):
    other = [("/other/depth/image_aligned", 1.0, image(1.0, np.ones((48, 64), np.uint16), "16UC1"))]
    path = write(tmp_path / "bag", [*two_pictures(), *other])
    with pytest.raises(InputError, match=r"found /camera/.*, /other/.*#depth=/TOPIC"):
        BagRgbdCamera(str(path))
    assert BagRgbdCamera(f"{path}#depth={DEPTH}").topics["info"] == INFO


def test_a_bag_without_depth_names_its_topics(tmp_path):
    path = write(tmp_path / "bag", [(INFO, 1.0, camera_info(1.0))])
    with pytest.raises(InputError, match="no topic of depth among /camera"):
        BagRgbdCamera(str(path))


def packed(time_s, values, form):
    kind = TYPES["sensor_msgs/msg/CompressedImage"]
    return kind(header(time_s), form, np.frombuffer(values, np.uint8))


def test_packed_depth_of_32_bits_is_inverse(tmp_path):
    """compressed_depth_image_transport keeps A / depth + B; millimetres of it would be silently wrong."""
    a, b, depth = 100.0, 3.0, np.full((48, 64), 0.5)
    raw = np.round(a / depth + b).astype(np.uint16)
    raw[0, 0] = 0
    content = struct.pack("<iff", 0, a, b) + cv2.imencode(".png", raw)[1].tobytes()
    messages = [(INFO, 1.0, camera_info(1.0)), (DEPTH, 1.0, packed(1.0, content, "32FC1; compressedDepth png"))]
    camera = BagRgbdCamera(str(write(tmp_path / "bag", messages)))
    camera.start()
    found = camera.newest().depth
    assert found[0, 0] == 0.0
    assert found[20, 20] == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize("model", ["equidistant", "fisheye"])
def test_a_fisheye_is_straightened_as_one(tmp_path, model):
    depth = np.zeros((48, 64), np.float32)
    depth[:, 40:] = 0.5  # an edge 8.5 px right of the middle, which a lens with r = f theta puts further out
    bent = camera_info(1.0, fx=20.0, model=model, d=(0.0,) * 4)
    messages = [(INFO, 1.0, bent), (DEPTH, 1.0, image(1.0, depth, "32FC1"))]
    camera = BagRgbdCamera(str(write(tmp_path / "bag", messages)))
    camera.start()
    row = camera.newest().depth[24]
    edge = int(np.argmax(row > 0.0))
    assert edge == pytest.approx(31.5 + 20.0 * math.tan(8.0 / 20.0), abs=1.0)


def test_a_binned_picture_has_its_own_lens(tmp_path):
    told = camera_info(1.0, fx=120.0)
    told.width, told.height, told.binning_x, told.binning_y = 128, 96, 2, 2
    told.k = np.array([120.0, 0, 63.5, 0, 120.0, 47.5, 0, 0, 1.0])
    messages = [(INFO, 1.0, told), (DEPTH, 1.0, image(1.0, np.ones((48, 64), np.float32), "32FC1"))]
    camera = BagRgbdCamera(str(write(tmp_path / "bag", messages)))
    camera.start()
    assert camera.newest().lens.tolist() == [60.0, 60.0, 31.5, 23.5]


@pytest.mark.parametrize(
    ("model", "d", "told"),
    [
        ("thin_prism", (0.1,) * 4, "model: found 'thin_prism', expected one of plumb_bob"),
        ("plumb_bob", (0.1,) * 3, r"distortion: found .*, expected 0 or 4 or 5 finite numbers for plumb_bob"),
    ],
)
def test_another_distortion_is_refused(tmp_path, model, d, told):
    messages = [
        (INFO, 1.0, camera_info(1.0, model=model, d=d)),
        (DEPTH, 1.0, image(1.0, np.ones((48, 64), np.float32), "32FC1")),
    ]
    with pytest.raises(InputError, match=f"{INFO}: {told}"):
        BagRgbdCamera(str(write(tmp_path / "bag", messages))).start()


@pytest.mark.parametrize(
    ("stamps", "told"), [((0.0, 0.0), "no time stamps"), ((2.0, 1.5), "a stamp of 1.500 s after 2.000 s")]
)
def test_pictures_without_times_in_order_are_refused(tmp_path, stamps, told):
    depth = np.ones((48, 64), np.float32)
    messages = [(INFO, 1.0, camera_info(1.0))]
    messages += [(DEPTH, 2.0 + k, image(stamp, depth, "32FC1")) for k, stamp in enumerate(stamps)]
    with pytest.raises(InputError, match=told):
        BagRgbdCamera(str(write(tmp_path / "bag", messages))).start()
