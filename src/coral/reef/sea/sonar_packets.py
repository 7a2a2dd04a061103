"""Packets of a real Sonar 3D-15, in its maker's Range Image Protocol (RIP2): bytes to range images, and back.

A packet may come from anyone on the network: whatever is in it, `decode_packet` returns or refuses it with a name.
Source: the maker's integration page, and its package wlsonar, which does the decoding.
"""

from __future__ import annotations

import math
import zlib
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np

from coral.errors import InputError, first_line, install_extra
from coral.reef.pilot.checks import UnfitMeasurement
from coral.reef.vehicle.range_image import RangeImage
from coral.reef.vehicle.sensing import HeardImage

IDENTIFIER = b"RIP2"
FRAME_BYTES = 12
"""Identifier, length and checksum."""
LARGEST_PACKET = 65_507
"""A packet fits into one datagram."""
LARGEST_MESSAGE = 1 << 20
"""Bytes of a message after decompression: twenty times what 256 by 64 beams need."""
MOST_BEAMS = 1024 * 256
GREATEST_PIXEL = 0xFFFF
"""Pixels have 16 bits."""
SCALE_M = 0.001
"""Step of the ranges in packets that we write."""


def decode_packet(packet: bytes) -> HeardImage | None:
    """Return the range image in a whole packet, at the time of the ping by the sonar's own clock (0: it tells none).

    None for another message of the protocol, such as a bitmap.

    Raises:
        UnfitMeasurement: It is no such packet, broken or hostile, or its numbers are none of a sonar.
        InputError: The package wlsonar is not installed.
    """
    from google.protobuf.message import DecodeError

    rip = load_protocol()
    _check_frame(packet)
    try:
        message = rip.unpackb(packet)
    except rip.UnknownProtobufTypeError:
        return None
    except (ValueError, DecodeError) as error:
        raise UnfitMeasurement("not decodable", first_line(error)) from None
    return _ping(message) if isinstance(message, rip.RangeImage) else None


def encode_packet(ping: HeardImage) -> bytes:
    """Return the packet that a sonar would send, for rehearsals and tests; what its pixels cannot reach has no echo."""
    rip = load_protocol()
    ranges = ping.value.ranges
    steps = np.where(np.isfinite(ranges), np.round(np.where(np.isfinite(ranges), ranges, 0.0) / SCALE_M), 0.0)
    pixels = np.where(steps <= GREATEST_PIXEL, steps, 0.0).astype(np.uint32)
    message = rip.RangeImage(
        speed_of_sound=1500.0,
        range=15.0,
        frequency=1_200_000,
        width=ranges.shape[1],
        height=ranges.shape[0],
        fov_horizontal=ping.value.hfov_deg,
        fov_vertical=ping.value.vfov_deg,
        image_pixel_scale=SCALE_M,
        image_pixel_data=pixels.ravel().tolist(),
    )
    seconds = math.floor(ping.t)
    message.header.timestamp.seconds = seconds
    message.header.timestamp.nanos = min(round(1e9 * (ping.t - seconds)), 999_999_999)
    data: bytes = rip.packb(message)
    return data


@cache
def load_protocol() -> ModuleType:
    """Import the maker's decoder.

    Raises:
        InputError: It is not installed.
    """
    try:
        import wlsonar.range_image_protocol as rip
    except ImportError:
        raise InputError("--sonar", "", "no wlsonar", install_extra("vehicle")) from None
    return rip  # type: ignore[no-any-return]


def _check_frame(packet: bytes) -> None:
    """Check what surrounds the message, and how large it says that it is, before anything is decompressed."""
    if len(packet) < FRAME_BYTES:
        raise UnfitMeasurement("cut off", f"{len(packet)} bytes, where {FRAME_BYTES} is the least")
    if packet[:4] != IDENTIFIER:
        raise UnfitMeasurement("wrong identifier", repr(packet[:4]))
    length = int.from_bytes(packet[4:8], "little")
    if length > len(packet):
        raise UnfitMeasurement("cut off", f"{len(packet)} of {length} bytes")
    if length != len(packet) or length > LARGEST_PACKET:
        raise UnfitMeasurement("wrong length", f"{len(packet)} bytes, where the packet says {length}")
    if zlib.crc32(packet[:-4]) != int.from_bytes(packet[-4:], "little"):
        raise UnfitMeasurement("wrong checksum")
    size = _decompressed_size(packet[8:-4])
    if size > LARGEST_MESSAGE:
        raise UnfitMeasurement("too large", f"{size} bytes when decompressed, where {LARGEST_MESSAGE} is the most")


def _decompressed_size(data: bytes) -> int:
    """Return the size that data compressed by snappy begin with: 7 bits a byte, the lowest first."""
    size = 0
    for k, byte in enumerate(data[:5]):
        size |= (byte & 0x7F) << 7 * k
        if byte < 0x80:
            return size
    raise UnfitMeasurement("not decodable", "no size before the compressed data")


def _ping(message: Any) -> HeardImage:
    """Check the numbers of a range image, and put it into ours: what has no echo is inf there, 0 in the packet."""
    width, height, pixels = message.width, message.height, message.image_pixel_data
    if not (width > 1 and height > 1 and width * height <= MOST_BEAMS and width * height == len(pixels)):
        raise UnfitMeasurement("wrong size", f"{width}x{height} beams, {len(pixels)} ranges")
    fields_of_view = message.fov_horizontal, message.fov_vertical
    if not all(0.0 < degrees <= 180.0 for degrees in fields_of_view):
        raise UnfitMeasurement("wrong field of view", "{:g} by {:g} degrees".format(*fields_of_view))
    # The scale has 32 bits: its shortest decimal is the number that the sonar meant.
    scale_m = float(str(np.float32(message.image_pixel_scale)))
    if not 0.0 < scale_m < 1.0:
        raise UnfitMeasurement("wrong scale", f"{scale_m:g} m for each step of a range")
    steps = np.fromiter(pixels, np.uint32, len(pixels)).reshape(height, width)
    if steps.max() > GREATEST_PIXEL:
        raise UnfitMeasurement("wrong range", f"{steps.max()} steps, where {GREATEST_PIXEL} is the most")
    ranges = np.where(steps > 0, steps * scale_m, math.inf).astype(np.float32)
    stamp = message.header.timestamp
    device_s = stamp.seconds + 1e-9 * stamp.nanos
    image = RangeImage(ranges, round(fields_of_view[0], 4), round(fields_of_view[1], 4))
    return HeardImage(device_s, image)
