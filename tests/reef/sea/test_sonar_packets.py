import struct
import sys
import zlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from coral.errors import InputError
from coral.reef.pilot.checks import UnfitMeasurement
from coral.reef.sea import sonar_packets
from coral.reef.sea.sonar_packets import decode_packet, encode_packet, load_protocol
from coral.reef.vehicle.range_image import RangeImage
from coral.reef.vehicle.sensing import Stamped

rip = pytest.importorskip("wlsonar.range_image_protocol")
import snappy  # noqa: E402
import wlsonar  # noqa: E402


def image(seed=0, shape=(64, 256)):
    rng = np.random.default_rng(seed)
    ranges = np.round(rng.uniform(0.3, 15.0, shape), 2).astype(np.float32)
    ranges[rng.random(shape) < 0.3] = np.inf
    return RangeImage(ranges, 90.0, 40.0)


def framed(payload, identifier=b"RIP2", length=None):
    """A packet with any payload, and the right checksum."""
    body = identifier + struct.pack("<I", len(payload) + 12 if length is None else length) + payload
    return body + struct.pack("<I", zlib.crc32(body))


def message(**changes):
    fields = {"width": 3, "height": 2, "fov_horizontal": 90.0, "fov_vertical": 40.0, "image_pixel_scale": 0.01}
    return rip.packb(rip.RangeImage(**{**fields, "image_pixel_data": [1, 2, 3, 4, 5, 6], **changes}))


def reason(packet):
    with pytest.raises(UnfitMeasurement) as error:
        decode_packet(packet)
    return error.value.reason


def test_an_image_comes_back_as_it_was_sent():
    sent = image()
    packet = encode_packet(Stamped(1_700_000_000.25, sent))
    assert packet[:4] == b"RIP2"
    got = decode_packet(packet)
    np.testing.assert_array_equal(got.value.ranges, sent.ranges)
    assert got.value.ranges.dtype == np.float32
    assert (got.value.hfov_deg, got.value.vfov_deg) == (90.0, 40.0)
    assert got.t == 1_700_000_000.25


def test_points_lie_where_the_makers_package_puts_them():
    sent = image(shape=(8, 16))
    theirs = wlsonar.range_image_to_xyz(rip.unpackb(encode_packet(Stamped(0.0, sent))))
    ours = sent.directions() * sent.ranges[..., None]
    for point, expected in zip(ours.reshape(-1, 3), theirs, strict=True):
        if expected is None:
            assert not np.isfinite(point).all()
        else:
            x, y, z = expected  # forward, right, down
            assert point == pytest.approx((x, -y, -z), abs=1e-5)


def test_a_range_beyond_the_pixels_has_no_echo():
    far = RangeImage(np.full((2, 2), 70.0, np.float32), 90.0, 40.0)
    assert np.isinf(decode_packet(encode_packet(Stamped(0.0, far))).value.ranges).all()


def test_other_messages_of_the_protocol_are_no_images():
    assert decode_packet(rip.packb(rip.BitmapImageGreyscale8(width=2, height=2))) is None
    assert decode_packet(rip.packb(rip.Header(sequence_id=3))) is None  # an internal one, unknown to the package


@pytest.mark.parametrize(
    ("name", "packet"),
    [
        ("cut off", b""),
        ("cut off", b"RIP2"),
        ("cut off", message()[:-1]),
        ("wrong identifier", b"JUNK" + message()[4:]),
        ("wrong length", message() + b"x"),
        ("wrong checksum", message()[:-1] + bytes([message()[-1] ^ 1])),
        ("too large", framed(b"\xff\xff\xff\xff\x0f" + b"\0" * 20)),
        ("too large", framed(snappy.compress(b"\0" * 1_200_000))),
        ("not decodable", framed(b"\xff\xff\xff\xff\xff\xff")),
        ("not decodable", framed(b"")),
        ("not decodable", framed(b"\x20" + b"\xff" * 30)),
        ("not decodable", framed(snappy.compress(b"\xff" * 50))),
        ("not decodable", framed(snappy.compress(b"\x0a" * 40))),
        ("wrong identifier", framed(b"", b"RIP1")),
        ("wrong size", message(width=4)),
        ("wrong size", message(width=0)),
        ("wrong size", message(width=1, height=6)),
        ("wrong size", message(width=2**31, height=2**31)),
        ("wrong size", message(image_pixel_data=[])),
        ("wrong field of view", message(fov_horizontal=0.0)),
        ("wrong field of view", message(fov_vertical=float("nan"))),
        ("wrong field of view", message(fov_vertical=float("inf"))),
        ("wrong scale", message(image_pixel_scale=0.0)),
        ("wrong scale", message(image_pixel_scale=float("nan"))),
        ("wrong scale", message(image_pixel_scale=-0.01)),
        ("wrong range", message(image_pixel_data=[70_000] * 6)),
    ],
)
def test_what_is_wrong_with_a_packet_has_a_name(name, packet):
    assert reason(packet) == name


@given(st.binary(max_size=300))
def test_any_bytes_in_a_right_frame_are_an_image_or_refused(payload):
    for packet in (payload, framed(payload), framed(snappy.compress(payload))):
        survives(packet)


@settings(max_examples=200)
@given(st.data())
def test_a_spoiled_packet_is_an_image_or_refused(data):
    """Bytes are changed inside of the message, and the checksum is right again."""
    plain = bytearray(snappy.uncompress(message()[8:-4]))
    for _ in range(data.draw(st.integers(1, 5))):
        plain[data.draw(st.integers(0, len(plain) - 1))] = data.draw(st.integers(0, 255))
    survives(framed(snappy.compress(bytes(plain[: data.draw(st.integers(0, len(plain)))]))))


def survives(packet):
    try:
        ping = decode_packet(packet)
    except UnfitMeasurement:
        return
    assert ping is None or ((ping.value.ranges > 0.0).all() and ping.value.ranges.size <= sonar_packets.MOST_BEAMS)


def test_without_the_package_one_line_says_what_to_install(monkeypatch):
    load_protocol.cache_clear()
    monkeypatch.setitem(sys.modules, "wlsonar.range_image_protocol", None)
    with pytest.raises(InputError, match=r"the extra vehicle: "):
        decode_packet(message())
    load_protocol.cache_clear()
